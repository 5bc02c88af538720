#pragma once

#include <algorithm>
#include <numeric>

#include <pliant/backend/array_copies.hpp>
#include <pliant/backend/copy_values.hpp>
#include <pliant/backend/host_values.hpp>
#include <pliant/backend/in_turn.hpp>
#include <pliant/backend/read_back.hpp>

#include "support/formulations.hpp"

// Loops, scans and sorts that are asked for at once, copies of several arrays, and values that loops write for the host, or read
// of it.
namespace pliant::test::in_turn_suite {

struct PutKeys {
  Index n;
  int shift;
  std::uint64_t* keys;
  Index* values;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    keys[i] = static_cast<std::uint64_t>((n - i) / 2) << shift;
    values[i] = i;
  }
};
struct Read {
  Index const* from;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return from[i]; }
};
/// to[i] = before[i] + the i-th key.
struct AddKeys {
  int shift;
  Index const* before;
  std::uint64_t const* keys;
  Index* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const {
    to[i] = before[i] + static_cast<Index>(keys[i] >> shift);
  }
};

TEMPLATE_LIST_TEST_CASE("steps see what those before them wrote, few or many", "[backend]",
                        Backends<double>) {
  TestType const backend;
  auto const at = [](Index i) { return static_cast<std::size_t>(i); };
  // Keys of few bits, of many, and of so many that a word has no room for a number beside them.
  for (int const shift : {0, 30, 48})
    for (Index const n : {0, 1, 2, 33, 255, 257, 2047, 2048, 2049, 9000, 60000}) {
      CAPTURE(n, shift);
      auto keys = zeros<std::uint64_t>(backend, at(n) + 1);
      auto values = zeros<Index>(backend, at(n) + 1), sums = zeros<Index>(backend, at(n) + 2),
           to = zeros<Index>(backend, at(n) + 1);
      detail::in_turn(backend, detail::LoopStep{n, PutKeys{n, shift, keys.data(), values.data()}},
                      detail::SortStep{n, keys.data(), values.data(), detail::key_bits(n) + shift},
                      detail::ScanStep{n, Read{values.data()}, sums.data()},
                      detail::LoopStep{n, AddKeys{shift, sums.data(), keys.data(), to.data()}});
      std::vector<Index> wanted_values(at(n)), wanted(at(n));
      std::iota(wanted_values.begin(), wanted_values.end(), Index{0});
      std::ranges::stable_sort(wanted_values, {}, [&](Index i) { return (n - i) / 2; });
      Index sum = 0;
      for (Index i = 0; i < n; ++i) {
        wanted[at(i)] = sum + (n - wanted_values[at(i)]) / 2;
        sum += wanted_values[at(i)];
      }
      wanted_values.push_back(0);
      wanted.push_back(0);
      CHECK(download<Index>(values) == wanted_values);
      CHECK(download<Index>(to) == wanted);
      CHECK(download<Index>(sums)[at(n)] == sum);
    }
}

struct Remainder {
  Index by;
  Index const* of;
  PLIANT_HOST_DEVICE Index operator()(Index i) const { return of[i] % by; }
};
struct Reverse {
  Index n;
  Index const* from;
  Index* to;
  PLIANT_HOST_DEVICE void operator()(Index i) const { to[n - 1 - i] = from[i]; }
};

TEMPLATE_LIST_TEST_CASE("steps of different lengths see what those before them wrote", "[backend]",
                        Backends<double>) {
  TestType const backend;
  for (Index const n : {2500, 100'003, (1 << 18) - 1, 1 << 18, (1 << 18) + 1, 700'000}) {
    CAPTURE(n);
    auto const size = static_cast<std::size_t>(n);
    std::vector<Index> numbers(size);
    std::iota(numbers.begin(), numbers.end(), Index{5});
    auto const from = upload(backend, numbers);
    auto first = zeros<Index>(backend, size + 1), reversed = zeros<Index>(backend, size),
         second = zeros<Index>(backend, size + 1), none = upload(backend, std::vector<Index>{7}),
         few = zeros<Index>(backend, 4);
    // A scan that writes nothing of an empty list but its sum, and one that reads the end of a long list.
    detail::in_turn(backend, detail::ScanStep{n, Remainder{3, from.data()}, first.data()},
                    detail::ScanStep{Index{0}, Read{from.data()}, none.data()},
                    detail::LoopStep{n, Reverse{n, first.data(), reversed.data()}},
                    detail::ScanStep{n, Remainder{2, reversed.data()}, second.data()},
                    detail::ScanStep{Index{3}, Remainder{100, second.data() + n - 2}, few.data()});
    std::vector<Index> wanted(size + 1), turned(size + 1);
    for (std::size_t i = 0; i < size; ++i) wanted[i + 1] = wanted[i] + numbers[i] % 3;
    for (std::size_t i = 0; i < size; ++i) turned[i + 1] = turned[i] + wanted[size - 1 - i] % 2;
    CHECK(download<Index>(first) == wanted);
    CHECK(download<Index>(second) == turned);
    CHECK(download<Index>(none) == std::vector<Index>{0});
    std::vector<Index> last{0, 0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) last[k + 1] = last[k] + turned[size - 2 + k] % 100;
    CHECK(download<Index>(few) == last);
  }
}

TEMPLATE_LIST_TEST_CASE("the host reads what loops wrote before it waited", "[backend]",
                        Backends<double>) {
  TestType const backend;
  std::vector<Index> const numbers{5, 7, 11};
  auto const from = upload(backend, numbers);
  ReadBack<TestType, Index> none, own(backend, 3);
  CHECK(none.size() == 0);
  own.set_all(3);
  CHECK(own.all() == std::vector<Index>{3, 3, 3});
  backend.for_each(2, detail::CopyValue<Index>{from.data(), own.data()});
  backend.synchronize();
  CHECK(own.all() == std::vector<Index>{5, 7, 3});
  CHECK(own.template first<2>() == std::array<Index, 2>{5, 7});
  none = std::move(own);
  backend.for_each(3, detail::CopyValue<Index>{from.data(), none.data()});
  backend.synchronize();
  CHECK(none.all() == numbers);
}

TEMPLATE_LIST_TEST_CASE("loops read values of the host, several lists one behind the other",
                        "[backend]", Backends<double>) {
  TestType const backend;
  auto const read = [&](Index const* values, std::size_t count) {
    auto copy = unset<Index>(backend, count);
    detail::copy_values<TestType, Index>(backend, values, copy.data(), count);
    return download<Index>(copy);
  };
  HostValues<TestType, Index> there;
  for (std::size_t const count : {3U, 0U, 5000U, 70000U, 40U}) {  // the last but one: many
    std::vector<Index> first(count), second(2 * count + 1);
    std::iota(first.begin(), first.end(), 7);
    std::iota(second.begin(), second.end(), -900);
    there.begin(backend, first.size() + second.size());
    auto const* const of_first = there.put(first);
    auto const* const of_second = there.put(second);
    CHECK(read(of_first, first.size()) == first);
    CHECK(read(of_second, second.size()) == second);
  }
}

TEMPLATE_LIST_TEST_CASE("copies of several arrays have their values, and zeros behind them",
                        "[backend]", Backends<double>) {
  TestType const backend;
  auto const numbered = []<class U>(U, std::size_t count) {
    std::vector<U> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<U>(i % 100 + 1);
    return values;
  };
  auto const wanted = []<class U>(std::vector<U> values, std::size_t kept, std::size_t count) {
    values.resize(kept);
    values.resize(count, U(0));
    return values;
  };
  detail::ArrayCopies<TestType> copies(backend);
  // More than one loop makes.
  std::vector<std::array<std::size_t, 3>> const sizes{
      {0, 0, 0},    {1, 1, 1},     {5, 5, 37},     {37, 37, 37},  {16, 16, 16},
      {64, 64, 96}, {96, 64, 64},  {1000, 0, 999}, {20, 3, 21},   {4096, 4096, 5000},
      {7, 7, 8},    {255, 31, 70}, {12, 12, 12},   {18, 18, 1800}};
  std::vector<typename TestType::template Array<std::uint8_t>> bytes, bytes_copied;
  std::vector<typename TestType::template Array<double>> numbers, numbers_copied;
  for (auto const& [size, kept, count] : sizes) {
    bytes.push_back(upload(backend, numbered(std::uint8_t{}, size)));
    numbers.push_back(upload(backend, numbered(double{}, size)));
    bytes_copied.push_back(copies.copy_of(std::as_const(bytes.back()).data(), kept, count));
    numbers_copied.push_back(
        kept == std::min(size, count)
            ? copies.template extended<double>(numbers.back(), count)
            : copies.copy_of(std::as_const(numbers.back()).data(), kept, count));
  }
  copies.make();
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    auto const [size, kept, count] = sizes[k];
    CAPTURE(size, kept, count);
    CHECK(download<std::uint8_t>(bytes_copied[k]) ==
          wanted(numbered(std::uint8_t{}, size), kept, count));
    CHECK(download<double>(numbers_copied[k]) == wanted(numbered(double{}, size), kept, count));
  }
}

}  // namespace pliant::test::in_turn_suite

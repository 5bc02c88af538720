#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <pliant/backend/host_array.hpp>
#include <pliant/backend/host_tasks.hpp>

// The verbs scan, select and sort on several threads of the host, which take a part of the list each. What they give does
// not depend on how many parts there are.
namespace pliant::detail {

/// [0, n) in a part for each thread, or fewer of at least `few`.
class ListParts {
 public:
  ListParts(HostTasks tasks, Index n, Index few)
      : tasks_(std::move(tasks)),
        n_(n),
        count_(std::clamp<Index>(n / few, 1, std::max(tasks_.threads(), 1))) {}
  Index size() const { return n_; }
  std::size_t count() const { return static_cast<std::size_t>(count_); }
  /// f(first, last, part) for each part.
  void operator()(FunctionRef<void(Index, Index, std::size_t)> f) const {
    tasks_(count_,
           [&](Index part) { f(first(part), first(part + 1), static_cast<std::size_t>(part)); });
  }

 private:
  Index first(Index part) const { return static_cast<Index>(std::int64_t{n_} * part / count_); }

  HostTasks tasks_;
  Index n_, count_;
};

/// Sums within each part, to which those of the parts before are added. `Parts`: ListParts or HostParts.
template <class Parts, class F>
void scan_in_parts(Parts const& parts, F const& f, Index* to) {
  std::vector<Index> sums(parts.count());
  parts([&](Index first, Index last, std::size_t part) {
    F const own = f;
    Index sum = 0;
    for (Index i = first; i < last; ++i) {
      Index const value = own(i);
      to[i] = sum;
      sum += value;
    }
    sums[part] = sum;
  });
  Index before = 0;
  for (Index& sum : sums) before += std::exchange(sum, before);
  if (parts.count() > 1)
    parts([&](Index first, Index last, std::size_t part) {
      for (Index i = first; i < last; ++i) to[i] += sums[part];
    });
  to[parts.size()] = before;
}

template <class F>
void select_in_parts(ListParts const& parts, F const& f, Index* to, Index* count) {
  std::vector<std::vector<Index>> found(parts.count());
  parts([&](Index first, Index last, std::size_t part) {
    F const own = f;
    std::vector<Index> numbers;
    for (Index i = first; i < last; ++i)
      if (own(i)) numbers.push_back(i);
    found[part] = std::move(numbers);
  });
  std::vector<std::ptrdiff_t> places(parts.count());
  std::ptrdiff_t before = 0;
  for (std::size_t part = 0; part < parts.count(); ++part) {
    places[part] = before;
    before += std::ssize(found[part]);
  }
  parts([&](Index, Index, std::size_t part) {
    std::copy(found[part].begin(), found[part].end(), to + places[part]);
  });
  *count = static_cast<Index>(before);
}

/// By one digit after the other, from the lowest on. Keys go to where those of lower digits end, and those of the same digit
/// in parts before.
inline void sort_in_parts(ListParts const& parts, std::uint64_t* keys, Index* values, int bits) {
  constexpr int digit_bits = 8;
  using Counts = std::array<Index, 1 << digit_bits>;
  auto const n = static_cast<std::size_t>(parts.size());
  auto other_keys = HostArray<std::uint64_t>::unset(n);
  auto other_values = HostArray<Index>::unset(n);
  std::uint64_t *from = keys, *to = other_keys.data();
  Index *values_from = values, *values_to = other_values.data();
  std::vector<Counts> places(parts.count());
  for (int shift = 0; shift < bits; shift += digit_bits) {
    auto const digit = [&](Index i) { return from[i] >> shift & (Counts{}.size() - 1); };
    parts([&](Index first, Index last, std::size_t part) {
      Counts counts{};
      for (Index i = first; i < last; ++i) ++counts[digit(i)];
      places[part] = counts;
    });
    Index before = 0;
    for (std::size_t d = 0; d < Counts{}.size(); ++d)
      for (Counts& of_part : places) before += std::exchange(of_part[d], before);
    parts([&](Index first, Index last, std::size_t part) {
      Counts next = places[part];
      for (Index i = first; i < last; ++i) {
        Index const place = next[digit(i)]++;
        to[place] = from[i];
        values_to[place] = values_from[i];
      }
    });
    std::swap(from, to);
    std::swap(values_from, values_to);
  }
  if (from == keys) return;
  parts([&](Index first, Index last, std::size_t) {
    std::copy(from + first, from + last, keys + first);
    std::copy(values_from + first, values_from + last, values + first);
  });
}

}  // namespace pliant::detail

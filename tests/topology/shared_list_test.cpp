#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include <pliant/error.hpp>
#include <pliant/reference.hpp>
#include <pliant/topology/hierarchy.hpp>
#include <pliant/topology/paged_list.hpp>
#include <pliant/topology/shared_list.hpp>
#include <pliant/topology/tree_on.hpp>

#include "support/catch.hpp"
#include "support/formulations.hpp"
#include "topology/tree_states.hpp"

namespace {
std::atomic<long> allocations_left{std::numeric_limits<long>::max()};
}

// Not inlined, so that compilers do not take malloc for another way to allocate.
[[gnu::noinline]] void* operator new(std::size_t size, std::nothrow_t const&) noexcept {
  return allocations_left-- > 0 ? std::malloc(size) : nullptr;
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* const memory = operator new(size, std::nothrow);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t line,
                                     std::nothrow_t const&) noexcept {
  auto const each = static_cast<std::size_t>(line);
  return allocations_left-- > 0 ? std::aligned_alloc(each, (size + each - 1) / each * each)
                                : nullptr;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

// Copies of a SharedList, what changes in one of them, and lists where memory runs out.
namespace pliant::test {

/// Changes what make() gives again and again, where memory runs out one allocation later each time, until the change ends. Behind
/// each there is check(what was made, whether the change ended).
template <class Make, class Change, class Check>
void fail_each_allocation(Make const& make, Change const& change, Check const& check) {
  constexpr int most = 1000;
  int failed = 0;
  for (bool done = false; !done && failed < most;) {
    auto own = make();
    allocations_left = failed;
    try {
      change(own);
      done = true;
    } catch (std::bad_alloc const&) {
      ++failed;
    } catch (Error const&) {
      ++failed;
    }
    allocations_left = std::numeric_limits<long>::max();
    check(own, done);
  }
  CHECK(failed > 0);
  CHECK(failed < most);
}

TEST_CASE("copies of a shared list change by themselves", "[topology]") {
  std::mt19937 random(1);
  auto const any = [&](std::size_t count) { return random() % count; };
  // Lists, and what they should be.
  std::vector<SharedList<int>> lists(1);
  std::vector<std::vector<int>> models(1);
  for (int round = 0; round < 2000; ++round) {
    std::size_t const i = any(lists.size());
    auto& list = lists[i];
    auto& model = models[i];
    switch (any(8)) {
      case 0:
        for (std::size_t k = any(8) == 0 ? 20000 : any(300); k > 0; --k) {
          list.push_back(round);
          model.push_back(round);
        }
        break;
      case 1:
        if (model.empty()) break;
        for (int k = 0; k < 3; ++k) {
          std::size_t const at = any(model.size());
          list.edit(at) = model[at] = -round;
        }
        break;
      case 2:
        model.resize(model.size() - any(model.size() / 8 + 1));
        list.shrink(model.size());
        break;
      case 3: {
        std::size_t const first = any(model.size() + 1), one_in = 50 + any(50);
        auto const stays = [&](std::size_t place) { return place % one_in != 0; };
        list.keep(first, stays);
        std::vector<int> left;
        for (std::size_t k = 0; k < model.size(); ++k)
          if (k < first || stays(k)) left.push_back(model[k]);
        model = left;
        break;
      }
      case 4: {
        std::size_t const from = model.size(), count = any(8) == 0 ? 20000 : any(300);
        list.extend(count);
        model.resize(from + count, round);
        for (std::size_t k = from; k < model.size(); ++k) list.edit(k) = round;
        break;
      }
      case 5: {
        if (model.empty()) break;
        std::size_t const from = model.size() - any(std::min<std::size_t>(model.size(), 1000));
        std::size_t const count = any(1000);
        std::vector<int> const before = model;
        model.resize(from);
        for (std::size_t k = 0; k < count; ++k) model.push_back(before[k % before.size()]);
        list.replace_from(from, count, [&](std::size_t k) { return list[k % before.size()]; });
        break;
      }
      case 6: {
        std::vector<Index> numbers;
        for (std::size_t at = any(400); at < model.size(); at += 1 + any(6000))
          numbers.push_back(static_cast<Index>(at));
        list.edit_listed(numbers, [](int& value, std::size_t k) { value = static_cast<int>(k); });
        for (std::size_t k = 0; k < numbers.size(); ++k)
          model[static_cast<std::size_t>(numbers[k])] = static_cast<int>(k);
        break;
      }
      default:
        if (lists.size() < 8) {
          auto const copy = list;
          lists.push_back(copy);
          models.push_back(std::vector<int>(model));
        } else {
          std::size_t const other = any(lists.size());
          auto const copy = list;
          auto const copy_of_model = model;
          lists[other] = copy;
          models[other] = copy_of_model;
        }
    }
  }
  for (std::size_t i = 0; i < lists.size(); ++i) {
    CHECK(models[i].size() > 2 * 64 * 256);  // several groups of pages
    CHECK(std::vector<int>(lists[i].begin(), lists[i].end()) == models[i]);
  }
}

TEST_CASE("a shared list is what it was where memory runs out", "[topology]") {
  constexpr std::size_t group = 64 * 256;
  std::vector<int> values(3 * group + 1000);
  std::iota(values.begin(), values.end(), 0);
  SharedList<int> const kept(values);
  std::fill(values.end() - 1000, values.end(), -1);
  auto const list_to_change = [&] {
    SharedList<int> list = kept;  // of which pages at the end are its own
    for (std::size_t i = values.size() - 1000; i < values.size(); ++i) list.edit(i) = -1;
    return list;
  };
  auto const check = [&](std::function<void(SharedList<int>&)> const& change, int pushed = 0) {
    fail_each_allocation(list_to_change, change, [&](SharedList<int> const& list, bool done) {
      auto wanted = values;
      for (int k = 0; k < pushed && wanted.size() < list.size(); ++k) wanted.push_back(k);
      bool const is_as_it_was = std::vector<int>(list.begin(), list.end()) == wanted;
      CHECK((done || is_as_it_was));
    });
  };
  check([](auto& list) { list.shrink(group + 300); });
  check([](auto& list) { list.edit(5) = 7; });
  check([](auto& list) { list.extend(20000); });
  check(
      [](auto& list) {
        for (int k = 0; k < 30; ++k) list.push_back(k);  // within the last page, and behind it
      },
      30);
  check([](auto& list) { list.replace_from(group + 300, 2000, [](std::size_t) { return 3; }); });
}

TEST_CASE("a list in pages takes back what did not end as memory ran out", "[topology]") {
  using List = PagedList<Reference<double>, Index>;
  constexpr std::size_t page = Page<Index>::entries;
  Reference<double> const backend;
  std::vector<Index> values(60 * page - 100);
  std::iota(values.begin(), values.end(), 0);
  SharedList<Index> const kept(values);
  auto const check = [&](std::function<void(List&)> const& change) {
    auto const list_to_change = [&] { return List(backend, kept); };
    fail_each_allocation(list_to_change, change, [&](List& list, bool) {
      list.take_back(backend);
      REQUIRE(list.size() == values.size());
      bool const is_as_it_was = list.download(backend) == values;
      CHECK(is_as_it_was);
    });
  };
  auto const changed = [&](std::size_t every) {
    return [&backend, every](List& list) {
      Index count = 0;
      auto const mark = list.marker(backend, &count);
      for (std::size_t p = 0; p < 60; p += every) mark(p);
      list.own(backend, count).replace.run(backend);
    };
  };
  check(changed(1));
  check(changed(2));
  check([&](List& list) { list.extend(backend, 50 * page).run(backend); });
  auto const replaced = [&](std::size_t count) {
    return [&backend, count](List& list) {
      auto const done = list.replace_from(backend, 20 * page + 5, count);
      done.replace.run(backend);
      done.extend.run(backend);
    };
  };
  check(replaced(70 * page));
  check(replaced(3 * page));
}

TEST_CASE("a tree in pages takes back a change that did not end as memory ran out", "[topology]") {
  Reference<double> const backend;
  Hierarchy<3> host(regular_mesh<Tet4>(5));
  std::vector<Index> cells(host.leaf_count());
  std::iota(cells.begin(), cells.end(), 0);
  auto const first = [&] {
    return TreeOn<Reference<double>>(backend, host.tree().lists(), *host.tree().cells_at_edges());
  };
  auto const lists = [](auto& tree) {
    return std::tuple(listed(tree.cells()), listed(tree.edges()), listed(tree.sides()),
                      listed(tree.rows()));
  };
  std::vector<Index> children(8 * cells.size());
  std::iota(children.begin(), children.end(), static_cast<Index>(cells.size()));
  auto const refine = [&](auto& tree) {
    (void)tree.refine(cells.data(), static_cast<Index>(cells.size()));
  };
  auto const coarsen = [&](auto& tree) {
    (void)tree.coarsen(children.data(), static_cast<Index>(children.size()));
  };
  auto const refined = [&] {
    auto tree = first();
    refine(tree);
    tree.keep();
    return tree;
  };
  auto const check = [&](auto const& make, auto const& change) {
    auto kept = make(), changed = make();
    auto const before = lists(kept);
    change(changed);
    auto const behind = lists(changed);
    fail_each_allocation(make, change, [&](auto& tree, bool) {
      tree.take_back();
      bool const is_as_it_was = lists(tree) == before;
      REQUIRE(is_as_it_was);
      change(tree);
      bool const is_changed = lists(tree) == behind;
      REQUIRE(is_changed);
    });
  };
  check(first, refine);
  check(refined, coarsen);
}

}  // namespace pliant::test

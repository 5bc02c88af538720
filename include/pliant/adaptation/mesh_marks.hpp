#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <pliant/adaptation/lists_on.hpp>
#include <pliant/adaptation/marked_there.hpp>
#include <pliant/adaptation/rule.hpp>
#include <pliant/topology/marked_elements.hpp>

// What rules want of elements, in the backend's memory: a number for each, of which bits put it on lists of MarkedElements.
namespace pliant::detail {

/// In the order in which an element goes to the first that asks for it; to `coarsen` and those behind it may go to several.
enum class MeshList { refine, raise, split, split_in_two, coarsen, lower, merge };
inline constexpr std::size_t mesh_lists = 7;

/// The bits that put an element of one type on each list.
struct MarkBits {
  std::array<std::uint32_t, mesh_lists> of{};

  std::uint32_t& operator[](MeshList list) { return of[static_cast<std::size_t>(list)]; }
  /// Whether a mark puts its element on a list.
  [[nodiscard]] bool takes(std::size_t list, std::uint32_t mark) const {
    return takes(of[list], others_before(list), mark);
  }
  static PLIANT_HOST_DEVICE bool takes(std::uint32_t bits, std::uint32_t before,
                                       std::uint32_t mark) {
    return (mark & bits) != 0 && (mark & before) == 0;
  }
  /// Bits of lists to which an element goes that does not go to this one.
  [[nodiscard]] std::uint32_t others_before(std::size_t list) const {
    constexpr auto first_of_last = static_cast<std::size_t>(MeshList::coarsen);
    std::uint32_t bits = 0;
    for (std::size_t l = 0; l < std::min(list, first_of_last); ++l) bits |= of[l];
    return bits;
  }
};

/// The marks of all types; those of a type are in its CriteriaWorkspace::mesh_marks, by its elements' internal numbers.
struct MeshMarks {
  std::vector<MarkBits> of_types{};
  int raised_rings = 0, max_level = 0;

  /// Adds those of a type whose elements rules mark each by the bit of its number.
  template <class... Rules>
  void add(std::tuple<Rules...> const& rules) {
    auto& bits = of_types.emplace_back();
    std::uint32_t own = 1;
    auto const look_at = [&]<class R>(R const& rule) {
      if constexpr (RefiningRule<R>) {
        bits[MeshList::refine] |= own;
        max_level = std::max(max_level, rule.options.max_level);
      } else if constexpr (CoarseningRule<R>) {
        bits[MeshList::coarsen] |= own;
      } else if constexpr (RaisingRule<R>) {
        bits[MeshList::raise] |= own;
        raised_rings = std::max(raised_rings, rule.options.ring);
      } else if constexpr (LoweringRule<R>) {
        bits[MeshList::lower] |= own;
      } else if constexpr (SplittingRule<R>) {
        bits[rule.options.triangles == 2 ? MeshList::split_in_two : MeshList::split] |= own;
      } else if constexpr (MergingRule<R>) {
        bits[MeshList::merge] |= own;
      }
      own <<= 1;
    };
    std::apply([&](auto const&... rule) { (look_at(rule), ...); }, rules);
  }
};

/// Lists of marked elements, on the host or in the backend's memory, by the place of each in MeshList.
template <class Marked>
auto in_order_of_lists(Marked& marked) {
  return std::array{&marked.refine,  &marked.raise, &marked.split, &marked.split_in_two,
                    &marked.coarsen, &marked.lower, &marked.merge};
}

/// Lists on the host.
template <class Parts>
MarkedElements marked_elements(Parts const& parts, MeshMarks const& marks) {
  MarkedElements marked;
  marked.raised_rings = marks.raised_rings;
  auto const lists = in_order_of_lists(marked);
  std::size_t type = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    for (auto* list : lists) list->emplace_back();
    auto const& bits = marks.of_types[type++];
    if (bits.of == MarkBits{}.of) return;
    visit_marked(parts, table, table.criteria.mesh_marks.data(),
                 [&](Index element, std::uint32_t mark) {
                   for (std::size_t l = 0; l < mesh_lists; ++l)
                     if (bits.takes(l, mark)) lists[l]->back().push_back(element);
                 });
  });
  return marked;
}

/// Whether an element's mark puts it on a list, for select.
struct IsOnList {
  std::uint32_t const* marks;
  std::uint32_t bits, before;
  PLIANT_HOST_DEVICE bool operator()(Index i) const {
    return MarkBits::takes(bits, before, marks[i]);
  }
};

/// The same in the backend's memory.
template <class Parts>
auto marked_there(Parts const& parts, MeshMarks const& marks) {
  using B = typename Parts::backend_type;
  auto const& backend = parts.backend;
  MarkedThere<B> marked;
  marked.raised_rings = marks.raised_rings;
  auto const lists = in_order_of_lists(marked);
  auto counts = zeros<Index>(backend, mesh_lists * marks.of_types.size());
  Index* count = counts.data();
  std::size_t type = 0;
  auto const select = [&](auto const& table, MeshList which, auto& of_types) {
    auto const& bits = marks.of_types[type];
    auto const l = static_cast<std::size_t>(which);
    auto& list = of_types.emplace_back();
    if (bits.of[l] != 0) {
      list.numbers = unset<Index>(backend, static_cast<std::size_t>(table.count()));
      backend.select(table.count(),
                     IsOnList{table.criteria.mesh_marks.data(), bits.of[l], bits.others_before(l)},
                     list.numbers.data(), count);
    }
    ++count;
  };
  parts.for_each_type([&](auto const& table, auto const&) {
    for (std::size_t l = 0; l < mesh_lists; ++l) select(table, static_cast<MeshList>(l), *lists[l]);
    ++type;
  });
  auto const found = download<Index>(counts);
  auto next = found.begin();
  type = 0;
  parts.for_each_type([&](auto const& table, auto const&) {
    for (auto* of_types : lists) {
      auto& list = (*of_types)[type];
      list.count = *next++;
      if (list.count == 0 || put_numbers(parts, table, list.numbers, list.count)) continue;
      std::vector<Index> numbers(static_cast<std::size_t>(list.count));
      list.numbers.download(numbers);
      for (Index& number : numbers) number = table.user_element(number);
      list.numbers.upload(numbers);
    }
    ++type;
  });
  return marked;
}

}  // namespace pliant::detail

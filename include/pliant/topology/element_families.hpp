#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include <pliant/backend/host_threads.hpp>
#include <pliant/config.hpp>
#include <pliant/math/place_iterator.hpp>
#include <pliant/topology/refinement_pattern.hpp>

namespace pliant {

/// Families of elements in a change of topology, in compressed rows: members of all stand in one list.
class ElementFamilies {
 public:
  /// An element: its type, by the place among the mesh's, and its number.
  struct Member {
    std::size_t type;
    Index element;
  };
  /// Elements that take the place of others, children in their order. A view of one in a list, which it must not outlive.
  struct Family {
    std::span<Member const> before{}, after{};
    std::span<double const> shares{};            ///< of those before in their volume
    RefinementPattern const* pattern = nullptr;  ///< by which the whole is divided; null: it is not
    bool mirrored = false;                       ///< whether the whole is (see RefinementPattern)
  };
  /// One that has its own lists, to write families down. No shares: 1 each.
  struct Single {
    std::vector<Member> before, after;
    std::vector<double> shares{};
    RefinementPattern const* pattern = nullptr;
    bool mirrored = false;
  };
  /// A family without its members: how many there are, and what Family has beside them.
  struct Shape {
    std::size_t before = 1, after = 1;
    RefinementPattern const* pattern = nullptr;
    bool mirrored = false;
  };

  ElementFamilies() = default;
  ElementFamilies(std::initializer_list<Single> families) {
    for (auto const& family : families) push_back(family);
  }
  /// Families with the shapes shape_of(f), and room for their members, which several threads may fill; shares are 1. On
  /// the threads of the host: `few` are worth one.
  template <class ShapeOf>
  ElementFamilies(std::size_t count, Index few, ShapeOf const& shape_of) : rows_(count) {
    detail::for_each_on_host(static_cast<Index>(count), few, [&](Index k) {
      auto const f = static_cast<std::size_t>(k);
      rows_[f] = shape_of(f);
    });
    std::size_t before = 0, after = 0;
    for (Shape& row : rows_) {
      row.before = before += row.before;
      row.after = after += row.after;
    }
    before_.resize(before);
    after_.resize(after);
    shares_.resize(before, 1.0);
  }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] bool empty() const { return rows_.empty(); }
  Family operator[](std::size_t f) const {
    Shape const from = first(f), &to = rows_[f];
    return {.before = std::span(before_).subspan(from.before, to.before - from.before),
            .after = std::span(after_).subspan(from.after, to.after - from.after),
            .shares = std::span(shares_).subspan(from.before, to.before - from.before),
            .pattern = to.pattern,
            .mirrored = to.mirrored};
  }
  [[nodiscard]] auto begin() const { return PlaceIterator(*this, 0); }
  [[nodiscard]] auto end() const { return PlaceIterator(*this, size()); }

  /// To fill.
  std::span<Member> before(std::size_t f) {
    return std::span(before_).subspan(first(f).before, rows_[f].before - first(f).before);
  }
  std::span<Member> after(std::size_t f) {
    return std::span(after_).subspan(first(f).after, rows_[f].after - first(f).after);
  }
  std::span<double> shares(std::size_t f) {
    return std::span(shares_).subspan(first(f).before, rows_[f].before - first(f).before);
  }
  void push_back(Single const& family) {
    before_.insert(before_.end(), family.before.begin(), family.before.end());
    after_.insert(after_.end(), family.after.begin(), family.after.end());
    shares_.insert(shares_.end(), family.shares.begin(), family.shares.end());
    shares_.resize(before_.size(), 1.0);
    rows_.push_back({.before = before_.size(),
                     .after = after_.size(),
                     .pattern = family.pattern,
                     .mirrored = family.mirrored});
  }

 private:
  /// Where the members of a family begin.
  [[nodiscard]] Shape first(std::size_t f) const {
    return f == 0 ? Shape{.before = 0, .after = 0} : rows_[f - 1];
  }

  std::vector<Shape> rows_;  // of members, where those of the family end
  std::vector<Member> before_, after_;
  std::vector<double> shares_;  // of those before
};

}  // namespace pliant

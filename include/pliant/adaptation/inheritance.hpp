#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <pliant/backend/dispatch.hpp>
#include <pliant/body/group_laws.hpp>

namespace pliant::detail {

/// Where a point of a child lies on its parent's cell; the fourth child of a triangle is turned by half a
/// turn.
template <class Cell>
Vector<double, 2> on_parent(Vector<double, 2> const& xi, int child) {
  if (child < Cell::corners) return 0.5 * (Cell::corner(child) + xi);
  Vector<double, 2> const middle{{{0.5}, {0.5}}};
  return middle - 0.5 * xi;
}

/// Appends what the points of an element remember: what the nearest point of its ancestor does.
template <class Table>
void inherit_history(Table const&, std::vector<double> const& rows, std::size_t ancestor, Tag tag,
                     std::vector<int> const& children, std::vector<double>& history) {
  constexpr int width = Table::Laws::history_count;
  if constexpr (width > 0) {
    std::size_t const first = history.size();
    history.resize(first + std::size_t{width}, 0.0);
    auto const fill = [&]<int G>(GroupNumber<G>) {
      using F = typename Table::template formulation<G>;
      if constexpr (history_size<F> > 0) {
        using Cell = typename F::element::cell;
        constexpr auto rule = F::quadrature::template rule<Cell>();
        constexpr int size = history_size<F> / F::points;
        for (int q = 0; q < F::points; ++q) {
          Vector<double, 2> at{{{rule.points[q][0]}, {rule.points[q][1]}}};
          for (auto child = children.rbegin(); child != children.rend(); ++child)
            at = on_parent<Cell>(at, *child);
          int nearest = 0;
          double least = std::numeric_limits<double>::infinity();
          for (int p = 0; p < F::points; ++p) {
            double const apart = std::hypot(rule.points[p][0] - at[0], rule.points[p][1] - at[1]);
            if (apart < least) {
              least = apart;
              nearest = p;
            }
          }
          for (int k = 0; k < size; ++k)
            history[first + static_cast<std::size_t>(size * q + k)] =
                rows[std::size_t{width} * ancestor + static_cast<std::size_t>(size * nearest + k)];
        }
      }
    };
    dispatch<Table::groups>(tag, fill);
  }
}

}  // namespace pliant::detail

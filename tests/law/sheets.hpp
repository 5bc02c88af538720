#pragma once

#include <pliant/law/decorators/plane_stress.hpp>

#include "support/difference_quotient.hpp"
#include "support/laws.hpp"

namespace pliant::test {

/// A law in a sheet, whichever it is.
struct AnySheet {
  AnyLaw<2> law;
  AnyLaw<3> solid;
  std::function<double(Tensor<double, 2> const&)> thickening;

  Tensor<double, 3> in_3d(Tensor<double, 2> const& h) const {
    auto state = in_space(h);
    state(2, 2) = thickening(h);
    return state;
  }
};

template <Ask ask, class L>
AnySheet any_sheet(L solid, Kind kind) {
  // Fibres that leave the plane would shear the sheet across its thickness.
  if constexpr (requires { solid.fibres; }) {
    auto const fibre = [&](Vector<double, 3> const& a) {
      if constexpr (requires { solid.law.dispersion; })
        return pliant::detail::structure(solid.law.dispersion, a);
      else
        return a;
    };
    solid.fibres[0] = fibre({{{0.6}, {0.8}, {0}}});
    if constexpr (std::extent_v<decltype(solid.fibres)> > 1)
      solid.fibres[1] = fibre({{{0.96}, {-0.28}, {0}}});
  }
  detail::Sheet<L> const sheet{solid};
  AnySheet any{any_law<ask, 2, double>(sheet, kind), {}, {}};
  if constexpr (ask == Ask::energy_and_stress) {
    any.solid = any_law<ask, 3, double>(solid, kind);
    any.thickening = [sheet](Tensor<double, 2> const& h) { return sheet.thickening(h); };
  }
  return any;
}

/// Calls visit(sheet) for each law, each in a section of its own.
template <Ask ask, class Visit>
void on_each_sheet(Visit const& visit) {
  on_each_maker([&](auto make, char const* name, Kind kind) {
    DYNAMIC_SECTION(name) { visit(any_sheet<ask>(make(1.0), kind)); }
  });
}

}  // namespace pliant::test

#pragma once

#include <pliant/adaptation/criterion/criterion.hpp>
#include <pliant/formulation/strong_ellipticity.hpp>

namespace pliant {

/// The least eigenvalue of the acoustic tensor that an element would have under the law of the Group<To>, Pa, at the
/// points of To's rule (see least_acoustic_eigenvalue): a guard for switches to a law that loses ellipticity,
///   when<F>(all(LawDiscrepancy<To>{} < 1e-6, LeastAcousticEigenvalue<To>{} > 0)).holds().become<To>()
template <class To>
struct LeastAcousticEigenvalue {
  static constexpr Unit unit = Unit::pascal;

  template <class State>
  PLIANT_HOST_DEVICE auto operator()(State const& e) const {
    using S = typename State::scalar;
    static_assert(std::same_as<typename State::element, typename To::element>,
                  "LeastAcousticEigenvalue<To>: To is a formulation on the same element");
    static_assert(keeps_internal_variables<typename State::formulation, To>,
                  "LeastAcousticEigenvalue<To>: To has the internal variables of the element's own "
                  "law, at the same points, or none");
    decltype(auto) law = e.template law_of<To>();
    S least(std::numeric_limits<builtin_scalar<S>>::max());
    for_each_point_of<To>(e.rest, e.u, [&](int q, S const&, Tensor<S, To::dim> const& h) {
      least = minimum(least, least_acoustic_eigenvalue(point_law(law, q), h));
    });
    return least;
  }
};

}  // namespace pliant

#pragma once

#include <pliant/backend/backend.hpp>
#include <pliant/body/group_laws.hpp>

// What quadrature points keep from step to step.
namespace pliant {

/// Calls visit(q, H) at each quadrature point of an element.
template <class F, class S, class Visit>
PLIANT_HOST_DEVICE void for_each_point(Nodal<typename F::element, S> const& rest,
                                       Nodal<typename F::element, S> const& u, Visit const& visit) {
  using E = typename F::element;
  visit_points<typename F::quadrature>([&](int q, auto, auto const&, auto const& h)
                                           PLIANT_INLINE { visit(q, h); },
                                       Coefficients<E, S>::of(rest), Coefficients<E, S>::of(u));
}

/// Brings internal variables up to the displacements u.
template <class T, class Laws>
struct CommitVisitor {
  static constexpr bool reads_elements = true;
  static constexpr int counters = 0, count = Laws::internal_variable_count;
  Laws groups;

  template <int G, class Own, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, Own const& own, V const& rest,
                                   V const& u) const {
    using F = typename Laws::template formulation<G>;
    Vector<std::remove_cvref_t<decltype(rest(0, 0))>, count> now{};
    if constexpr (internal_variables_of<F> > 0) {
      constexpr int size = internal_variables_of<F> / F::points;
      ElementField<T const, 0> const all{groups.data.internal_variables, groups.data.elements};
      for_each_point<F>(rest, u, [&](int q, auto const& h) PLIANT_INLINE {
        auto const internal = own(all.template part<size>(size * q));
        auto const next = groups.template law<G>().advanced(internal, h);
        for (int k = 0; k < size; ++k) now[size * q + k] = next[k];
      });
    }
    return now;
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, count> const& now, Again const&,
                                 Tally const&) const {
    ElementField<T, count> const all{groups.data.internal_variables, groups.data.elements};
    for (int k = 0; k < internal_variables_of<typename Laws::template formulation<G>>; ++k)
      all(e, k) = now[k];
  }
};

/// An element is in group G at rest: its points are as if they had always been where they are.
template <int G, class Laws, class V>
PLIANT_HOST_DEVICE void equilibrate_points(Laws const& groups, Index e, V const& rest, V const& u) {
  using F = typename Laws::template formulation<G>;
  using T = std::remove_cvref_t<decltype(rest(0, 0))>;
  constexpr int size = internal_variables_of<F> / F::points;
  for_each_point<F>(rest, u, [&](int q, auto const& h) PLIANT_INLINE {
    auto const internal = groups.template law<G>().equilibrated(h);
    ElementField<T, Laws::internal_variable_count> const all{groups.data.internal_variables,
                                                             groups.data.elements};
    for (int k = 0; k < size; ++k) all(e, size * q + k) = internal[k];
  });
}

/// An element goes from one group to another. Where that keeps internal variables, what is kept is how they differ
/// from those at rest: another law's stress at the same place is no deformation.
template <int From, int To, class Laws, class V>
PLIANT_HOST_DEVICE void carry_internal_variables(Laws const& groups, Index e, V const& rest,
                                                 V const& u) {
  using F = typename Laws::template formulation<To>;
  using T = std::remove_cvref_t<decltype(rest(0, 0))>;
  if constexpr (!keeps_internal_variables<typename Laws::template formulation<From>, F>) {
    equilibrate_points<To>(groups, e, rest, u);
  } else if constexpr (From != To && internal_variables_of<F> > 0) {
    constexpr int size = internal_variables_of<F> / F::points;
    for_each_point<F>(rest, u, [&](int q, auto const& h) PLIANT_INLINE {
      auto const before = groups.template law<From>().equilibrated(h);
      auto const now = groups.template law<To>().equilibrated(h);
      ElementField<T, Laws::internal_variable_count> const all{groups.data.internal_variables,
                                                               groups.data.elements};
      for (int k = 0; k < size; ++k)
        all(e, size * q + k) = all(e, size * q + k) + (now[k] - before[k]);
    });
  }
}

/// Carries the internal variables of elements that were put into other groups by hand.
template <class T, class Laws>
struct CarryInternalVariables {
  static constexpr int counters = 0;
  Laws groups;
  // (elements): their groups; of none, points are at rest; null: all are of none
  Tag const* before;

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G>, V const& rest, V const&) const {
    return Vector<std::remove_cvref_t<decltype(rest(0, 0))>, 1>::zero();
  }
  template <int G, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, Vector<T, 1> const&, Again const& again,
                                 Tally const&) const {
    if constexpr (internal_variables_of<typename Laws::template formulation<G>> > 0) {
      auto const [rest, u] = again();
      if (before == nullptr)
        equilibrate_points<G>(groups, e, rest, u);
      else
        carry<G, 0>(e, rest, u);
    }
  }

 private:
  template <int G, int From, class V>
  PLIANT_HOST_DEVICE void carry(Index e, V const& rest, V const& u) const {
    if constexpr (From < std::tuple_size_v<decltype(Laws::laws)>) {
      if (before[e] == From)
        carry_internal_variables<From, G>(groups, e, rest, u);
      else
        carry<G, From + 1>(e, rest, u);
    } else {
      equilibrate_points<G>(groups, e, rest, u);
    }
  }
};

}  // namespace pliant

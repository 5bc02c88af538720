#pragma once

#include <cmath>
#include <random>
#include <string>

#include "law/by_hand.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// Laws beside their twins, whose stress is written by hand, through the same element loop.
namespace pliant::bench {

/// The states at which twins are compared: gradients of a few tenths, with J > 0.
inline std::vector<Tensor<double, 3>> states_to_compare() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-0.2, 0.2);
  std::vector<Tensor<double, 3>> states(20);
  for (auto& h : states)
    for (auto& row : h.entries)
      for (double& x : row) x = part(random);
  return states;
}
inline double largest(Tensor<double, 3> const& a) {
  double m = 0;
  for (auto const& row : a.entries)
    for (double x : row) m = std::max(m, std::isfinite(x) ? std::abs(x) : INFINITY);
  return m;
}

/// Throws Error unless two laws at a point have one stress, and one tangent if asked, but for rounding.
template <bool Tangents, class A, class B>
void check_twins(std::string const& name, A const& derived, B const& by_hand) {
  auto const compare = [&](char const* what, auto const& p, auto const& q) {
    if (!(largest(p - q) < 1e-12 * largest(p)))
      throw Error("law bench: the " + std::string(what) + " of " + name +
                  " by hand is not the derived one");
  };
  auto const states = states_to_compare();
  for (std::size_t k = 0; k < states.size(); ++k) {
    auto const& h = states[k];
    compare("stress", stress(derived, h), stress(by_hand, h));
    if constexpr (Tangents) {
      auto const& dh = states[(k + 1) % states.size()];
      compare("tangent", stress_tangent_product(derived, h, dh),
              stress_tangent_product(by_hand, h, dh));
    }
  }
}

/// The values per element of a law with fibres: the same for all.
template <class L>
constexpr auto fibres() {
  if constexpr (!LawPerElement<L>) {
    return std::array<double, 0>{};
  } else if constexpr (L::element_values == 3) {
    return std::array<double, 3>{3, 4, 1};
  } else {
    static_assert(L::element_values == 6);
    return std::array<double, 6>{2, 1, 1, -1, 2, 0.5};
  }
}

/// The law at a point of any element.
template <class L>
auto at_any_element(L const& law) {
  if constexpr (LawPerElement<L>) {
    Vector<double, L::element_values> values;
    constexpr auto all = fibres<L>();
    for (int k = 0; k < L::element_values; ++k) values[k] = all[static_cast<std::size_t>(k)];
    return law.at(values);
  } else {
    return law;
  }
}

/// A law in the shape that kernels take, and what its elements keep.
template <class F, class B>
struct TimedLaw {
  using T = typename B::scalar;
  using L = typename F::template law<T>;
  typename B::template Array<T> values;
  GroupLaws<T, F> laws;

  TimedLaw(B const& backend, L const& law, Index elements)
      : values(upload(backend, rows(elements))), laws{{law}, {values.data(), nullptr, elements}} {}

 private:
  static std::vector<T> rows(Index elements) {
    std::vector<T> all;
    for (double x : fibres<L>()) all.insert(all.end(), static_cast<std::size_t>(elements), T(x));
    return all;
  }
};

template <class F, class B>
void time_force_of(benchmark::State& state, B const& backend,
                   typename F::template law<typename B::scalar> const& law, int cells) {
  auto& p = Problem<B, typename F::element>::of(backend, cells);
  TimedLaw<F, B> const timed(backend, law, p.elements.count());
  ForceKernel<decltype(timed.laws)> const kernel{timed.laws};
  measure(state, backend, [&] {
    p.clear_forces(backend);
    backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u());
  });
  report(state, p, {.read = 2, .written = 1}, 0, 0);
}
template <class F, class B>
void time_tangent_of(benchmark::State& state, B const& backend,
                     typename F::template law<typename B::scalar> const& law, int cells) {
  using T = typename B::scalar;
  auto& p = Problem<B, typename F::element>::of(backend, cells);
  TimedLaw<F, B> const timed(backend, law, p.elements.count());
  TangentKernel<T, decltype(timed.laws)> const kernel{timed.laws, T(1)};
  measure(state, backend, [&] {
    p.clear_forces(backend);
    backend.template accumulate<1>(p.elements, kernel, p.f(), p.rest(), p.u(), p.du());
  });
  report(state, p, {.read = 3, .written = 1}, 0, 0);
}

/// In the caches of a CPU, where only computing counts; a GPU is filled.
template <Element E, class B>
int cells_for_laws() {
  return on_gpu<B> ? usual_cells<E, B>() : few_cells<E, B>();
}

/// Calls visit(backend, name) for the backend that everything is timed on, in both precisions.
template <class Visit>
void on_main_backend(Visit const& visit) {
#if defined(__CUDACC__)
  visit(Cuda<float>{}, "Cuda");
  visit(Cuda<double>{}, "Cuda");
#elif defined(_OPENMP)
  visit(OpenMP<float>{{.threads = 1}}, "OpenMP-1");
  visit(OpenMP<double>{{.threads = 1}}, "OpenMP-1");
#else
  visit(Reference<float>{}, "Reference");
  visit(Reference<double>{}, "Reference");
#endif
}

/// Adds the force or the tangent product of a law and of its twin on both elements.
template <bool Tangents, template <class> class L, template <class> class Twin>
void add_pair(std::string const& name, L<double> const& law) {
  check_twins<Tangents>(name, at_any_element(law), at_any_element(Twin<double>{law}));
  on_main_backend([&](auto const& backend, std::string const& backend_name) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    auto const single = law_cast<T>(law);
    auto const add_one = [&]<class F>(typename F::template law<T> const& timed, char const* how) {
      using E = typename F::element;
      int const cells = cells_for_laws<E, B>();
      add_named(std::string(Tangents ? "tangent " : "force ") + how + "/" + E::name() + "/" + name +
                    "/" + precision_name<T>() + "/" + backend_name + "/" +
                    std::to_string(element_count<E>(cells)),
                [backend, timed, cells](benchmark::State& state) {
                  if constexpr (Tangents)
                    time_tangent_of<F>(state, backend, timed, cells);
                  else
                    time_force_of<F>(state, backend, timed, cells);
                });
    };
    auto const add_both = [&]<class E>(E) {
      add_one.template operator()<Usual<E, L>>(single, "derived");
      add_one.template operator()<Usual<E, Twin>>({single}, "by hand");
    };
    add_both(Tet4{});
    add_both(Hex8{});
  });
}

}  // namespace pliant::bench

#pragma once

#include "support/bodies.hpp"
#include "support/measure.hpp"
#include "support/registration.hpp"

// What a simulator calls that owns its state: forces and tangent products of arrays in its own order
// of nodes, three numbers each.
namespace pliant::bench {

template <class TheBody>
struct UserArrays {
  using T = typename TheBody::scalar;
  typename TheBody::backend_type::template Array<T> u, du, f;

  explicit UserArrays(TheBody const& body)
      : u(upload(body.backend(), flat(shaken(body.mesh().nodes, 1)))),
        du(upload(body.backend(), flat(shaken(body.mesh().nodes, 2)))),
        f(zeros<T>(body.backend(), u.size())) {}

 private:
  static std::vector<T> flat(std::vector<Point<TheBody::dim>> const& field) {
    std::vector<T> values;
    for (auto const& row : field)
      for (double x : row) values.push_back(static_cast<T>(x));
    return values;
  }
};

template <class F, class B>
void time_add_force(benchmark::State& state, B const& backend, int cells) {
  auto& body = made_once([&] { return shaken_body<F>(backend, cells); });
  UserArrays arrays(body);
  measure(state, backend, [&] { body.add_force(arrays.u.data(), arrays.f.data()); });
  report_elements(state, body);
}
template <class F, class B>
void time_add_tangent_product(benchmark::State& state, B const& backend, int cells) {
  auto& body = made_once([&] { return shaken_body<F>(backend, cells); });
  UserArrays arrays(body);
  measure(state, backend,
          [&] { body.add_tangent_product(arrays.u.data(), arrays.du.data(), arrays.f.data()); });
  report_elements(state, body);
}

inline void add_embeddings() {
  on_each_backend_and_precision([](auto const& backend, std::string const& name, Role role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    using T = typename B::scalar;
    if (role != Role::main) return;
    auto const both = [&]<class E>(E) {
      using F = Usual<E, SaintVenantKirchhoff>;
      int const cells = usual_cells<E, B>();
      add<F, T>("add_force", name, cells, [backend, cells](benchmark::State& state) {
        time_add_force<F>(state, backend, cells);
      });
      add<F, T>("add_tangent_product", name, cells, [backend, cells](benchmark::State& state) {
        time_add_tangent_product<F>(state, backend, cells);
      });
    };
    both(Tet4{});
    both(Hex8{});
  });
}

}  // namespace pliant::bench

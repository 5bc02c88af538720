#pragma once

#include "solver/without_matrix_suite.hpp"

// One linear system of quadratic elements, without a matrix by each preconditioner: of a block, whose elements lie in the boxes
// of a grid, and of it bent to part of a ring.
namespace pliant::bench {

enum class Shape { block, ring };

template <Element E>
Mesh<E> quadratic_mesh(Shape shape, int cells) {
  auto mesh = mesh::box<E>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  if (shape == Shape::ring)
    for (auto& x : mesh.nodes) {
      double const r = 1 + x[0], angle = 1.2 * x[1];
      x = {r * std::cos(angle), r * std::sin(angle), x[2] + 0.2 * x[0]};
    }
  return mesh;
}

/// Pulled apart at its ends, under Hooke's law, to a residual of 1e-6.
template <class F, class B>
void time_quadratic(benchmark::State& state, B const& backend, Shape shape, int cells,
                    Way const& way) {
  auto const mesh = quadratic_mesh<typename F::element>(shape, cells);
  Body body{backend, mesh, block_material, Group<F>{}};
  body.clamp(mesh.boundary("bottom"));
  body.drive(mesh.boundary("top"), [](double) { return Point<3>{0.1, 0, -0.1}; });
  std::vector<Point<3>> const rest(static_cast<std::size_t>(body.nodes()));
  NewtonReport report;
  double first_setup = -1;
  time_each(
      state, [&] { body.set_displacements(rest); },
      [&] {
        report = solve_static(
            body, {.tolerance = 1e-6, .linear = way.method, .preconditioner = way.preconditioner});
        if (first_setup < 0) first_setup = report.linear.setup;
        return report.linear.setup;
      });
  report_solve(state, body, report);
  state.counters["first_setup_ms"] = 1e3 * first_setup;
}

inline void add_quadratic() {
  on_each_backend<double>([](auto const& backend, std::string const& name, Role role) {
    if (role == Role::scalar) return;
    using B = std::remove_cvref_t<decltype(backend)>;
    auto const add = [&]<class F>(std::type_identity<F>, std::vector<int> const& sizes) {
      for (auto [shape, name_of_shape] : {std::pair{Shape::block, "block"}, {Shape::ring, "ring"}})
        for (int cells : sizes)
          for (auto [by, name_of_way] : {std::pair{Preconditioner::nodal_blocks, "nodal_blocks"},
                                         {Preconditioner::multigrid, "multigrid"},
                                         {Preconditioner::p_multigrid, "p_multigrid"},
                                         {Preconditioner::automatic, "automatic"}})
            benchmark::RegisterBenchmark(
                (std::string("quadratic/") + F::element::name() + "/" + name_of_shape + "/" + name +
                 "/" + name_of_way + "/" + std::to_string(cells))
                    .c_str(),
                [=, by = by, shape = shape](benchmark::State& state) {
                  time_quadratic<F>(state, backend, shape, cells, {LinearMethod::matrix_free, by});
                })
                ->UseManualTime()
                ->Iterations(2)
                ->Unit(benchmark::kMillisecond);
    };
    bool const large = on_gpu<B>;
    add(std::type_identity<Formulation<Tet10, Gauss<2>, Hooke>>{},
        large ? std::vector{22, 48, 75} : std::vector{7, 14, 22});
    add(std::type_identity<Formulation<Hex20, Gauss<3>, Hooke>>{},
        large ? std::vector{28, 60, 94} : std::vector{9, 17, 28});
    add(std::type_identity<Formulation<Hex27, Gauss<3>, Hooke>>{},
        large ? std::vector{22, 48, 75} : std::vector{7, 14, 22});
  });
}

}  // namespace pliant::bench

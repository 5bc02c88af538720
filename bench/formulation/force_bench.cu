#include "formulation/force_suite.hpp"
#include "formulation/plain_kernels.cuh"
#include "support/program.hpp"

namespace pliant::bench {

template <Ending Which, class F, class T>
void add_plain(char const* what, Cuda<T> const& backend, int cells) {
  using E = typename F::element;
  add<F, T>(what, "Cuda", cells, [backend, cells](benchmark::State& state) {
    auto& p = Problem<Cuda<T>, E>::of(backend, cells);
    ForceKernel<GroupLaws<T, F>> const kernel{soft_laws<T, F>()};
    measure(state, backend, [&] {
      if (Which == Ending::scatter) p.clear_forces(backend);
      launch_plain<Which>(backend, p.elements, kernel, p.f(), p.rest(), p.u());
    });
    report(state, p, {.read = 2, .written = Which == Ending::scatter}, 0, flops_per_force<E>());
  });
}

/// Beside the forces, on the same meshes.
void add_plain_kernels() {
  on_each_backend_and_precision([](auto const& backend, std::string const&, Role) {
    using B = std::remove_cvref_t<decltype(backend)>;
    auto const both = [&]<class E>(E, int cells) {
      using F = Usual<E, SaintVenantKirchhoff>;
      add_plain<Ending::scatter, F>("scatter", backend, cells);
      add_plain<Ending::none, F>("compute", backend, cells);
    };
    both(Tet4{}, few_cells<Tet4, B>());
    both(Tet4{}, usual_cells<Tet4, B>());
    both(Tet4{}, many_cells<Tet4>());
    both(Hex8{}, usual_cells<Hex8, B>());
  });
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, [] {
    pliant::bench::add_forces();
    pliant::bench::add_plain_kernels();
  });
}

#include "guard/kernels.hpp"

// Compiled for what ptxas says of the kernels; not run.
void launch_guarded_kernels() {
  using namespace pliant;
  bench::on_each_guarded([]<class K>(K) {
    using F = typename K::formulation;
    Cuda<typename K::scalar> const backend;
    auto& problem = bench::Problem<Cuda<typename K::scalar>, typename F::element>::of(backend, 4);
    bench::add_force<F>(backend, problem);
    bench::add_tangent<F>(backend, problem);
  });
}

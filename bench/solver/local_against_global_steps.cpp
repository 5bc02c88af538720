#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include <pliant/pliant.hpp>
#include <pliant/solver/local_steps.hpp>

#if defined(__CUDACC__)
#include <pliant/cuda.hpp>
#else
#include <pliant/openmp.hpp>
#endif

// What local time steps save: a cube of Tet4 under Saint Venant-Kirchhoff in which one compact hundredth of the
// elements is ten times smaller than the others, against steps of one size. Both run in turns in one program; the
// least times count. Arguments, all optional: cells along an edge, threads, macro steps in a call, turns.
namespace pliant::bench {

/// A ball of a hundredth of the cube, drawn together to a tenth; the shell around it takes up the room.
inline Mesh<Tet4> cube_with_a_small_ball(int cells) {
  auto mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
  Point<3> const middle{0.31, 0.37, 0.43};
  double const ball = std::cbrt(0.01 * 3 / (4 * 3.14159265358979)), shell = 0.25, factor = 0.1;
  for (auto& p : mesh.nodes) {
    double r = 0;
    for (std::size_t k = 0; k < 3; ++k) r += (p[k] - middle[k]) * (p[k] - middle[k]);
    r = std::sqrt(r);
    if (r >= shell) continue;
    double const shrink =
        r < ball ? factor
                 : (factor * ball + (r - ball) * (shell - factor * ball) / (shell - ball)) / r;
    for (std::size_t k = 0; k < 3; ++k) p[k] = middle[k] + shrink * (p[k] - middle[k]);
  }
  return mesh;
}

template <class B, class Work>
double seconds(B const& backend, Work const& work) {
  using Clock = std::chrono::steady_clock;
  backend.synchronize();
  auto const start = Clock::now();
  work();
  backend.synchronize();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <class B>
void compare(B const& backend, int cells, int macro_steps, int turns) {
  using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  auto const mesh = cube_with_a_small_ball(cells);
  auto const make = [&] {
    Body body{backend, mesh, Elastic{1e5, 0.3, 1e3}, Group<F>{}};
    body.clamp(mesh.boundary("left"));
    body.set_gravity({0, 0, -1});
    return body;
  };
  auto local = make(), global = make();
  int const never = 1 << 28;
  LocalSteps step{{.check_interval = never, .refresh_interval = never, .watch_interval = never}};
  double const dt = 0.9 * stable_step(global);
  CentralDifference other{
      {.step = dt, .check_interval = never, .refresh_interval = never, .watch_interval = never}};
  double const first = seconds(backend, [&] { step(local); });
  other(global, 4);
  int const steps = std::max(1, static_cast<int>(macro_steps * step.macro_step() / dt / 2));
  double least = std::numeric_limits<double>::infinity(), least_global = least;
  for (int k = 0; k < turns; ++k) {
    least = std::min(least, seconds(backend, [&] { step(local, macro_steps); }) / macro_steps);
    least_global = std::min(least_global, seconds(backend, [&] { other(global, steps); }) / steps);
  }

  auto const& schedule = *local.parts().schedule;
  double const fine = std::ldexp(step.macro_step(), -schedule.finest);
  double const as_fine = least_global * step.macro_step() / (fine * 0.9 / 0.8);
  std::printf("%s, %d Tet4, %zu-bit numbers: levels 0 to %d in %.3e s, one step %.3e s\n",
              B::name(), local.parts().layout.template table<Tet4>().count(),
              8 * sizeof(typename B::scalar), schedule.finest, step.macro_step(), dt);
  for (int l = 0; l <= schedule.finest; ++l)
    std::printf("  level %d: %ld patches, %d nodes from here on\n", l,
                static_cast<long>(std::ranges::count(schedule.patch_levels[0], l)),
                schedule.node_counts[static_cast<std::size_t>(l)]);
  std::printf("  first macro step, with levels %.3f s; macro step %.4f s, global step %.5f s\n",
              first, least, least_global);
  std::printf("  faster than global steps for the same time: %.2f\n",
              least_global * step.macro_step() / dt / least);
  std::printf("  time over that of global steps of the finest level: %.3f; bar %.3f\n",
              least / as_fine, schedule.evaluations * 0.9 / 0.8 + 0.15);
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  auto const argument = [&](int k, int otherwise) {
    return argc > k ? std::atoi(argv[k]) : otherwise;
  };
  int const cells = argument(1, 55), macro_steps = argument(3, 12), turns = argument(4, 8);
#if defined(__CUDACC__)
  pliant::bench::compare(pliant::Cuda<float>{}, cells, macro_steps, turns);
#else
  pliant::OpenMP<float> const backend{{.threads = argument(2, 1)}};
  pliant::bench::compare(backend, cells, macro_steps, turns);
#endif
}

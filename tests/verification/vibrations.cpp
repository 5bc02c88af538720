#include "verification/support/grading.hpp"
#include "verification/support/modal.hpp"

// Frequencies: NAFEMS FV32 and the plate of FV52 with an exact solution (REFERENCES, section 4), the seed
// beam and the bar of section 11.
namespace pliant::verification {

/// FV32: a tapered membrane, depth 5 m to 1 m over 10 m.
template <Element E>
void tapered(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, PlaneStress<Hooke>::law>;
  auto const runs = on_meshes(sizes, 6, [](int n) {
    auto mesh = graded<E>({n, n}, towards_start(1.5), towards_ends(1.5));
    for (auto& p : mesh.nodes) p = {10 * p[0], (5 - 4 * p[0]) * (p[1] - 0.5)};
    auto body = body_of<F>(mesh, {200e9, 0.3, 8000});
    body.clamp(mesh.boundary("left"));
    return frequencies(body, 6, MassMatrix::consistent);
  });
  char const* const ours[] = {"44.617", "130.01", "162.69", "245.99", "379.72", "391.40"};
  for (std::size_t k = 0; k < 6; ++k)
    table.compare({"4, FV32, mode " + std::to_string(k + 1) + ", Hz", name_of<F>(), "graded n x n"},
                  runs, k, printed(ours[k]));
}

/// FV52 with u_z and the tangential u held on the sides: modes are exact Rayleigh-Lamb and SH waves.
template <Element E>
void vibrating_plate(Table& table, std::vector<int> const& sizes) {
  using F = Formulation<E, Full<E>, Hooke>;
  double const exact[] = {45.97121156,  109.85686161, 109.85686161, 155.04341824, 155.04341824,
                          168.81929420, 205.86461205, 205.86461205, 219.26450483};
  auto const runs = on_meshes(sizes, 9, [](int n) {
    auto const mesh = mesh::box<E>({.size = {10, 10, 1}, .cells = {n, n, n / 4}});
    auto body = body_of<F>(mesh, {200e9, 0.3, 8000});
    for (char const* side : {"left", "right"}) body.hold(mesh.boundary(side), 2 + 4);
    for (char const* side : {"front", "back"}) body.hold(mesh.boundary(side), 1 + 4);
    return frequencies(body, 9, MassMatrix::consistent);
  });
  // Frequencies of quadratic elements converge as h^4.
  for (std::size_t k : {0u, 1u, 3u, 5u, 6u, 8u})
    table.approach(
        {"4, FV52-exact, mode " + std::to_string(k + 1) + ", Hz", name_of<F>(), "n x n x n/4"},
        runs, k, within(1e-8, exact[k]), 4);
}

/// Section 11: the seed beam on 20 x 2, both kinds of mass, by another code.
void seed_beam(Table& table) {
  using F = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const mesh =
      mesh::rectangle<Quad4>({.size = {1, 0.1}, .cells = {20, 2}, .origin = {0, -0.05}});
  auto body = body_of<F>(mesh, {2e6, 0.3, 1000});
  body.clamp(mesh.boundary("left"));
  char const* const lumped[] = {"0.80552538", "4.79458659", "11.76336206", "12.52376198"};
  char const* const consistent[] = {"0.80706091", "4.85417238", "11.77055067", "12.85925055"};
  auto const rows = [&](char const* kind, MassMatrix mass, char const* const* expected) {
    auto const runs = on_meshes({20}, 4, [&](int) { return frequencies(body, 4, mass); });
    for (std::size_t k = 0; k < 4; ++k)
      table.compare({std::string("11, seed beam, ") + kind + ", mode " + std::to_string(k + 1),
                     name_of<F>(), "n x n/10"},
                    runs, k, printed(expected[k]));
  };
  rows("lumped", MassMatrix::lumped, lumped);
  rows("consistent", MassMatrix::consistent, consistent);
}
void seed_beam_converged(Table& table) {
  using F = Formulation<Quad9, Gauss<3>, Hooke>;
  auto const runs = on_meshes({20, 40, 80}, 4, [](int n) {
    auto mesh = graded<Quad9>({n, n / 4}, towards_start(2), towards_ends(2));
    for (auto& p : mesh.nodes) p[1] = 0.1 * p[1] - 0.05;
    auto body = body_of<F>(mesh, {2e6, 0.3, 1000});
    body.clamp(mesh.boundary("left"));
    return frequencies(body, 4, MassMatrix::consistent);
  });
  char const* const expected[] = {"0.75258", "4.5017", "11.7463", "11.816"};
  for (std::size_t k = 0; k < 4; ++k)
    table.compare(
        {"11, seed beam, mode " + std::to_string(k + 1) + ", Hz", name_of<F>(), "graded n x n/4"},
        runs, k, printed(expected[k]));
}

/// A fixed-free bar of linear elements without Poisson's ratio, L = c = 1: rad/s.
void bar(Table& table) {
  using F = Formulation<Quad4, Gauss<2>, Hooke>;
  auto const first = [&](MassMatrix mass) {
    return on_meshes({4, 8, 16}, 1, [&](int n) {
      auto const mesh = mesh::rectangle<Quad4>({.size = {1, 1}, .cells = {n, 1}});
      auto body = body_of<F>(mesh, {1, 0, 1});
      body.clamp(mesh.boundary("left"));
      body.hold(mesh.boundary("top"), 2);
      body.hold(mesh.boundary("bottom"), 2);
      return std::array{2 * std::numbers::pi * frequencies(body, 1, mass)[0]};
    });
  };
  char const* const lumped[] = {"1.560722576129", "1.568274245273", "1.570165578477"};
  char const* const consistent[] = {"1.580908018849", "1.573320825388", "1.571427226881"};
  auto const rows = [&](char const* kind, Runs const& runs, char const* const* expected) {
    for (std::size_t k = 0; k < 3; ++k)
      table.compare({std::string("11, bar, ") + kind + ", rad/s", name_of<F>(), "n x 1"}, {runs[k]},
                    0, within(1e-10, printed(expected[k]).value));
  };
  rows("lumped", first(MassMatrix::lumped), lumped);
  rows("consistent", first(MassMatrix::consistent), consistent);
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  using namespace pliant::verification;
  Table table("Vibrations: FV32, FV52, bar and beam (4, 11)", argc, argv);
  bar(table);
  seed_beam(table);
  seed_beam_converged(table);
  tapered<Quad9>(table, {12, 24, 40});
  tapered<Quad8>(table, {12, 24, 40});
  vibrating_plate<Hex20>(table, {8, 12});
  if constexpr (has_full_form)
    if (table.full()) vibrating_plate<Hex27>(table, {8, 12});
  return table.finish();
}

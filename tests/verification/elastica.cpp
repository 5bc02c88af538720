#include "verification/support/statics.hpp"

// REFERENCES, section 2: the elastica under an end load (Bisshopp and Drucker 1945), by a solid so slender
// that shear and stretch are below 1e-3 of its length. Without Poisson's ratio, for the clamp's sake.
namespace pliant::verification {

struct Shape {
  double load, shortening, drop;  // P L²/(E I); both over L
};

template <Element E>
void bend(Table& table) {
  using F = Formulation<E, Full<E>, SaintVenantKirchhoff>;
  int const cells = 80;
  double const height = 0.01, young = 12e6, stiffness = young * std::pow(height, 3) / 12;
  auto const mesh =
      mesh::rectangle<E>({.size = {1, height}, .cells = {cells, 1}, .origin = {0, -height / 2}});
  auto body = body_of<F>(mesh, {young, 0, 1});
  body.clamp(mesh.boundary("left"));
  auto const tip = [&] {
    auto const u = body.displacements();
    Point<2> mean{};
    for (Index n : nodes_of(mesh.boundary("right")))
      for (std::size_t k = 0; k < 2; ++k) mean[k] += u[static_cast<std::size_t>(n)][k] / 3;
    return mean;
  };
  for (Shape const& s : {Shape{1, 0.05643324, 0.30172077}, Shape{2, 0.16064172, 0.49345748},
                         Shape{3, 0.25442018, 0.60325344}, Shape{5, 0.38762836, 0.71379152},
                         Shape{10, 0.55499560, 0.81060902}}) {
    auto const runs = on_meshes({cells}, 2, [&](int) {
      body.set_loads(
          traction_loads(mesh, mesh.boundary("right"), Point<2>{0, -s.load * stiffness / height}));
      solve_static(body, {.max_iterations = 200, .tolerance = 1e-7});
      return tip();
    });
    std::string const load = "load " + number(s.load);
    table.compare({"2, " + load + ", shortening", name_of<F>(), "n x 1"}, runs, 0,
                  within(1e-3, -s.shortening));
    table.compare({"2, " + load + ", drop", name_of<F>(), "n x 1"}, runs, 1, within(1e-3, -s.drop));
  }
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  using namespace pliant;
  verification::Table table("Elastica (2)", argc, argv);
  verification::bend<Quad9>(table);
  verification::bend<Quad8>(table);
  return table.finish();
}

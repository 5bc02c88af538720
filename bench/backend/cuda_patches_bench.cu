#include "support/measure.hpp"
#include "support/program.hpp"
#include "support/registration.hpp"
#include "support/report.hpp"

// Forces by patches of several sizes and threads per block: what cuda/tuning.hpp is chosen from.
namespace pliant::bench {

using Shape = std::array<int, 2>;  // elements per patch, threads per block

template <class F, class T>
void add_shape(int cells, Shape shape, NodeOrder order) {
  using E = typename F::element;
  bool const in_fans = order == NodeOrder::any_even;
  std::string const name =
      (in_fans ? "fans/" : "patches/") + std::to_string(shape[0]) + "x" + std::to_string(shape[1]);
  static Cuda<T> const backend;
  add<F, T>(name, "Cuda", cells, [cells, shape, order](benchmark::State& state) {
    auto& p = Problem<Cuda<T>, E>::of(backend, cells);
    auto const& table = std::get<0>(OrderedMesh<E>::of(cells).numbering.tables);
    CudaElements<T, E::nodes> const elements(backend, table, std::vector<Tag>(table.size(), 0),
                                             p.nodes, shape, order);
    ForceKernel<GroupLaws<T, F>> const kernel{soft_laws<T, F>()};
    measure(state, backend, [&] {
      p.clear_forces(backend);
      backend.template accumulate<1>(elements, kernel, p.f(), p.rest(), p.u());
    });
    report(state, p, {.read = 2, .written = 1}, 0, flops_per_force<E>());
  });
}

template <class E, class T>
void add_shapes(std::vector<int> const& sizes, std::vector<Shape> const& shapes,
                NodeOrder order = NodeOrder::as_given) {
  for (int cells : sizes)
    for (Shape shape : shapes) add_shape<Usual<E, SaintVenantKirchhoff>, T>(cells, shape, order);
}

void add_all() {
  using B = Cuda<float>;
  std::vector<Shape> const small{{96, 96}, {128, 128}, {192, 192}, {256, 256}};
  std::vector<Shape> const large{{256, 128}, {384, 128}, {384, 192}, {512, 256}, {768, 256}};
  std::vector<int> const few{few_cells<Tet4, B>()};
  std::vector<int> const many{usual_cells<Tet4, B>(), many_cells<Tet4>()};
  add_shapes<Tet4, float>(few, small);
  add_shapes<Tet4, double>(few, small);
  add_shapes<Tet4, float>(many, large);
  add_shapes<Tet4, double>(many, large);
  std::vector<Shape> const in_fans{{384, 64}, {576, 96}, {768, 96}, {768, 128}};
  add_shapes<Tet4, float>(many, in_fans, NodeOrder::any_even);
  add_shapes<Tet4, double>(many, in_fans, NodeOrder::any_even);
  add_shapes<Hex8, double>({usual_cells<Hex8, B>()}, {{64, 64}, {128, 128}, {256, 128}});
}

}  // namespace pliant::bench

int main(int argc, char** argv) {
  return pliant::bench::run(argc, argv, [] { pliant::bench::add_all(); });
}

#include <random>

#include <pliant/body/numbering.hpp>
#include <pliant/cuda.hpp>
#include <pliant/force/element_kernels.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/law/saint_venant_kirchhoff.hpp>
#include <pliant/mesh/box.hpp>
#include <pliant/reference.hpp>

#include "support/catch.hpp"

namespace pliant::test::cuda_fans_test {

using Table = std::vector<std::array<Index, 4>>;
template <class T>
using Laws = GroupLaws<T, Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>,
                       Formulation<Tet4, Gauss<1>, NeoHookean>>;
template <class T>
Laws<T> laws() {
  Elastic const soft{5.2, 0.3, 1.5};
  return {{law_cast<T>(SaintVenantKirchhoff<double>::from(soft)),
           law_cast<T>(NeoHookean<double>::from(soft))}};
}

/// A box of tetrahedra in the order of a body, in two groups and none, and fields on it.
struct Scene {
  Table table;
  std::vector<Tag> tags;
  std::vector<double> rest, displacement, change;
  Index nodes;

  explicit Scene(int cells) {
    auto const mesh = mesh::box<Tet4>({.size = {1, 1, 1}, .cells = {cells, cells, cells}});
    Numbering<Tet4> const numbering(mesh);
    table = std::get<0>(numbering.tables);
    nodes = static_cast<Index>(mesh.nodes.size());
    std::mt19937 random(7);
    std::uniform_real_distribution<double> small(-0.2 / cells, 0.2 / cells);
    for (Index user : numbering.user_node)
      for (std::size_t k = 0; k < node_stride; ++k) {
        rest.push_back(k < 3 ? mesh.nodes[static_cast<std::size_t>(user)][k] + small(random) : 0);
        displacement.push_back(k < 3 ? small(random) : 0);
        change.push_back(k < 3 ? small(random) : 0);
      }
    for (std::size_t e = 0; e < table.size(); ++e)
      tags.push_back(std::array<Tag, 4>{0, 1, 1, no_group}[random() % 4]);
  }
};

template <class T>
auto upload_as(auto const& backend, std::vector<double> const& values) {
  return upload(backend, std::vector<T>(values.begin(), values.end()));
}

/// What accumulate(backend, elements, out, rest, u, du) adds up.
template <class B, class Accumulate>
std::vector<double> sums(B const& backend, typename B::template Elements<4> const& elements,
                         Scene const& scene, Accumulate const& accumulate) {
  using T = typename B::scalar;
  auto const rest = upload_as<T>(backend, scene.rest);
  auto const u = upload_as<T>(backend, scene.displacement);
  auto const du = upload_as<T>(backend, scene.change);
  auto out =
      zeros<T>(backend, static_cast<std::size_t>(node_stride) *
                            static_cast<std::size_t>(scene.nodes + elements.scratch_nodes()));
  using Field = NodeField<T const, 3>;
  accumulate(backend, elements, NodeField<T, 3>{out.data()}, Field{rest.data()}, Field{u.data()},
             Field{du.data()});
  backend.synchronize();
  auto const values = download<T>(out);
  return {values.begin(), values.begin() + node_stride * static_cast<std::ptrdiff_t>(scene.nodes)};
}

struct AddForces {
  template <class B, class E, class Out, class In>
  void operator()(B const& backend, E const& elements, Out out, In rest, In u, In) const {
    using T = typename B::scalar;
    backend.template accumulate<2>(elements, ForceKernel<Laws<T>>{laws<T>()}, out, rest, u);
  }
};
struct AddTangents {
  template <class B, class E, class Out, class In>
  void operator()(B const& backend, E const& elements, Out out, In rest, In u, In du) const {
    using T = typename B::scalar;
    backend.template accumulate<2>(elements, TangentKernel<T, Laws<T>>{laws<T>(), T(2)}, out, rest,
                                   u, du);
  }
};
/// Of a kernel that is not said to be symmetric.
struct AddRowSums {
  template <class B, class E, class Out, class In>
  void operator()(B const& backend, E const& elements, Out out, In rest, In u, In) const {
    using T = typename B::scalar;
    backend.template accumulate<2>(elements, RowSumKernel<Laws<T>>{laws<T>()}, out, rest, u);
  }
};
/// Of one component: how many elements in groups a node has.
struct CountElements {
  template <int G, class S, int N, int C>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G>, Matrix<S, N, C> const&) const {
    Matrix<S, N, 1> ones;
    for (int a = 0; a < N; ++a) ones(a, 0) = S(1);
    return ones;
  }
};
struct AddCounts {
  template <class B, class E, class Out, class In>
  void operator()(B const& backend, E const& elements, Out out, In rest, In, In) const {
    using T = typename B::scalar;
    backend.template accumulate<2>(elements, CountElements{}, NodeField<T, 1>{out.data}, rest);
  }
};
/// Of every third patch, from a list with room for so many.
template <class Add>
struct OverSome {
  Index patch_size;
  std::size_t room;
  Add add{};
  template <class B, class E, class Out, class... In>
  void operator()(B const& backend, E const& elements, Out out, In... in) const {
    std::vector<Index> list{0};
    for (Index p = 0; p * patch_size < elements.count(); p += 3) list.push_back(p);
    list[0] = static_cast<Index>(list.size()) - 1;
    list.resize(std::max(list.size(), room + 1));
    auto const active = upload(backend, list);
    add(backend, over(elements, active), out, in...);
    backend.synchronize();
  }
};

template <class T>
void check_equal(std::vector<double> const& got, std::vector<double> const& expected) {
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    largest = std::max(largest, std::abs(expected[i]));
    // Written so that a NaN fails.
    if (!(std::abs(got[i] - expected[i]) <= difference))
      difference = std::abs(got[i] - expected[i]);
  }
  REQUIRE(largest > 0);
  CHECK(difference <= (sizeof(T) == 8 ? 1e-12 : 1e-4) * largest);
}

template <class T, class Add>
void compare(Scene const& scene, std::array<int, 2> size_and_threads, Add const& add) {
  Reference<double> const host;
  Cuda<T> const gpu;
  Reference<double>::Elements<4> const expected(host, scene.table, 2, scene.tags, scene.nodes);
  CudaElements<T, 4> const fans(gpu, scene.table, scene.tags, scene.nodes, size_and_threads,
                                NodeOrder::any_even);
  REQUIRE(fans.has_fans());
  REQUIRE(fans.patch_size() == size_and_threads[0]);
  check_equal<T>(sums(gpu, fans, scene, add), sums(host, expected, scene, add));
}

TEST_CASE("fans accumulate what elements do, of several groups and none", "[cuda]") {
  Scene const scene(9);
  for (std::array<int, 2> shape : {std::array{768, 128}, std::array{384, 64}, std::array{1024, 128},
                                   std::array{96, 96}, std::array{70, 70}}) {
    INFO(shape[0] << " elements, " << shape[1] << " threads");
    compare<float>(scene, shape, AddForces{});
    compare<double>(scene, shape, AddForces{});
    compare<float>(scene, shape, AddTangents{});
    compare<double>(scene, shape, AddTangents{});
  }
}

TEST_CASE("kernels that know a first node run over a table in fans", "[cuda]") {
  Scene const scene(6);
  compare<float>(scene, {768, 128}, AddRowSums{});
  compare<double>(scene, {768, 128}, AddRowSums{});
}

/// What `compare` does, of some patches; hosts have other patches, so that tags leave out the rest.
template <class T>
void compare_some(Scene const& scene, int patch_size, std::size_t room) {
  Reference<double> const host;
  Cuda<T> const gpu;
  auto tags = scene.tags;
  for (std::size_t e = 0; e < tags.size(); ++e)
    if (e / static_cast<std::size_t>(patch_size) % 3 != 0) tags[e] = no_group;
  Reference<double>::Elements<4> const expected(host, scene.table, 2, tags, scene.nodes);
  CudaElements<T, 4> const fans(gpu, scene.table, scene.tags, scene.nodes, {patch_size, 64},
                                NodeOrder::any_even);
  REQUIRE(fans.has_fans());
  check_equal<T>(sums(gpu, fans, scene, OverSome<AddForces>{patch_size, room}),
                 sums(host, expected, scene, AddForces{}));
}

TEST_CASE("fans of the patches in a list accumulate, and no others", "[cuda]") {
  Scene const scene(9);
  for (std::size_t room : {std::size_t{0}, std::size_t{detail::few_patches} + 1}) {
    INFO("room for " << room);
    compare_some<float>(scene, 128, room);
    compare_some<double>(scene, 768, room);
  }
}

TEST_CASE("other numbers of components accumulate over a table in fans", "[cuda]") {
  Scene const scene(6);
  compare<float>(scene, {768, 128}, AddCounts{});
  compare<double>(scene, {768, 128}, AddCounts{});
}

TEST_CASE("tables have fans where they are large, and where that is allowed", "[cuda]") {
  constexpr auto tuning = detail::fan_tuning<double>();
  Cuda<double> const gpu;
  Scene const small(9), large(37);
  REQUIRE(static_cast<Index>(small.table.size()) < tuning.least_elements);
  REQUIRE(static_cast<Index>(large.table.size()) >= tuning.least_elements);
  auto const has_fans = [&](Scene const& scene, NodeOrder order) {
    return CudaElements<double, 4>(gpu, scene.table, 2, scene.tags, scene.nodes, order).has_fans();
  };
  CHECK_FALSE(has_fans(small, NodeOrder::any_even));
  CHECK_FALSE(has_fans(large, NodeOrder::as_given));
  CHECK(has_fans(large, NodeOrder::any_even));
}

TEST_CASE("patches with too many nodes for fans have none", "[cuda]") {
  Scene scene(1);
  scene.table.clear();
  for (Index e = 0; e < 1000; ++e) scene.table.push_back({4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3});
  std::vector<Tag> const tags(scene.table.size(), Tag(0));
  CudaElements<double, 4> const apart(Cuda<double>{}, scene.table, tags, 4000, {768, 128},
                                      NodeOrder::any_even);
  CHECK_FALSE(apart.has_fans());
}

}  // namespace pliant::test::cuda_fans_test

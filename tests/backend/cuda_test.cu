#include <random>

#include <pliant/cuda.hpp>
#include <pliant/element/linear.hpp>
#include <pliant/formulation/physics.hpp>
#include <pliant/law/hooke.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/law/saint_venant_kirchhoff.hpp>
#include <pliant/reference.hpp>

#include "support/catch.hpp"

using namespace pliant;
using pliant::test::Approx;

static_assert(Backend<Cuda<float>> && Backend<Cuda<double>>);

namespace {

// Two groups of one table, and what mechanics does with them.
template <class First, class Second, class T>
struct Laws {
  typename First::template law<T> first;
  typename Second::template law<T> second;

  template <int G>
  PLIANT_HOST_DEVICE auto const& of(GroupNumber<G>) const {
    if constexpr (G == 0)
      return first;
    else
      return second;
  }
  template <int G>
  using formulation = std::conditional_t<G == 0, First, Second>;
};

template <class L>
struct Force {
  L laws;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G> g, V const& rest, V const& u) const {
    return force<typename L::template formulation<G>>(laws.of(g), rest, u);
  }
};
template <class L>
struct Energy {
  L laws;
  template <int G, class V>
  PLIANT_HOST_DEVICE auto operator()(GroupNumber<G> g, V const& rest, V const& u) const {
    return energy<typename L::template formulation<G>>(laws.of(g), rest, u);
  }
};
/// Writes each element's energy, counts the elements of each group and those above a bound.
template <class L, class T>
struct EnergyVisitor {
  static constexpr int counters = 3;
  L laws;
  T bound;
  T* energies;      // (elements)
  T* first_values;  // (elements)

  template <int G, class V>
  PLIANT_HOST_DEVICE auto evaluate(GroupNumber<G> g, V const& rest, V const& u) const {
    using S = std::remove_cvref_t<decltype(rest(0, 0))>;
    return Vector<S, 1>{{{energy<typename L::template formulation<G>>(laws.of(g), rest, u)}}};
  }
  template <int G, class V, class Again, class Tally>
  PLIANT_HOST_DEVICE void finish(GroupNumber<G>, Index e, V const& values, Again const& again,
                                 Tally const& tally) const {
    energies[e] = values[0];
    first_values[e] = std::get<1>(again())(0, 0);
    tally(G, 1);
    if (values[0] > bound) tally(2, 1);
  }
};

/// A grid of cells, warped, cut into elements, with random displacements and tags.
template <class E>
struct Scene {
  std::vector<std::array<Index, E::nodes>> connectivity;
  std::vector<double> rest, displacement;  // (nodes, 4)
  std::vector<Tag> tags;
  Index nodes = 0;

  explicit Scene(int n) {
    int const layers = E::dim == 3 ? n : 0;
    auto const number = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
    for (int k = 0; k < std::max(layers, 1); ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          cut([&](int x, int y, int z) { return number(i + x, j + y, k + z); });
    nodes = (n + 1) * (n + 1) * (layers + 1);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> small(-0.15 / n, 0.15 / n);
    for (Index v = 0; v < nodes; ++v)
      for (int k = 0; k < node_stride; ++k) {
        int const place[] = {v % (n + 1), v / (n + 1) % (n + 1), v / (n + 1) / (n + 1), 0};
        bool const used = k < E::dim;
        rest.push_back(used ? double(place[k]) / n + small(random) : 0);
        displacement.push_back(used ? small(random) : 0);
      }
    for (std::size_t e = 0; e < connectivity.size(); ++e)
      tags.push_back(std::array<Tag, 4>{0, 1, 1, no_group}[random() % 4]);
  }

 private:
  template <class Corner>
  void cut(Corner const& v) {
    if constexpr (E::nodes == 3) {
      connectivity.push_back({v(0, 0, 0), v(1, 0, 0), v(1, 1, 0)});
      connectivity.push_back({v(0, 0, 0), v(1, 1, 0), v(0, 1, 0)});
    } else if constexpr (E::nodes == 8) {
      connectivity.push_back({v(0, 0, 0), v(1, 0, 0), v(1, 1, 0), v(0, 1, 0), v(0, 0, 1),
                              v(1, 0, 1), v(1, 1, 1), v(0, 1, 1)});
    } else if constexpr (E::dim == 2) {
      connectivity.push_back({v(0, 0, 0), v(1, 0, 0), v(1, 1, 0), v(0, 1, 0)});
    } else {  // Kuhn's six
      connectivity.push_back({v(0, 0, 0), v(1, 0, 0), v(1, 1, 0), v(1, 1, 1)});
      connectivity.push_back({v(0, 0, 0), v(1, 1, 0), v(0, 1, 0), v(1, 1, 1)});
      connectivity.push_back({v(0, 0, 0), v(0, 1, 0), v(0, 1, 1), v(1, 1, 1)});
      connectivity.push_back({v(0, 0, 0), v(0, 1, 1), v(0, 0, 1), v(1, 1, 1)});
      connectivity.push_back({v(0, 0, 0), v(0, 0, 1), v(1, 0, 1), v(1, 1, 1)});
      connectivity.push_back({v(0, 0, 0), v(1, 0, 1), v(1, 0, 0), v(1, 1, 1)});
    }
  }
};

struct Outcome {
  std::vector<double> forces, energies, first_values, counters;
  double energy;
};

template <class T>
std::vector<T> cast(std::vector<double> const& values) {
  return {values.begin(), values.end()};
}
template <class T>
std::vector<double> widened(std::vector<T> const& values) {
  return {values.begin(), values.end()};
}

template <class First, class Second, class B>
Outcome outcome(B const& backend, Scene<typename First::element> const& scene) {
  using T = typename B::scalar;
  constexpr int nodes = First::nodes, dim = First::dim;
  using L = Laws<First, Second, T>;
  L const laws{{T(2), T(1)}, {T(3), T(2)}};
  typename B::template Elements<nodes> elements(backend, scene.connectivity, 2, scene.tags,
                                                scene.nodes);
  auto rest = upload(backend, cast<T>(scene.rest));
  auto displacement = upload(backend, cast<T>(scene.displacement));
  auto out = zeros<T>(
      backend, static_cast<std::size_t>(node_stride * (scene.nodes + elements.scratch_nodes())));
  auto energies = zeros<T>(backend, scene.connectivity.size());
  auto first_values = zeros<T>(backend, scene.connectivity.size());
  auto counters = zeros<double>(backend, 3);
  NodeField<T const, dim> const x{rest.data()}, u{displacement.data()};

  backend.template accumulate<2>(elements, Force<L>{laws}, NodeField<T, dim>{out.data()}, x, u);
  double const sum = backend.template sum_elements<2>(elements, Energy<L>{laws}, x, u);
  backend.template visit<2>(elements,
                            EnergyVisitor<L, T>{laws, T(sum / double(scene.tags.size())),
                                                energies.data(), first_values.data()},
                            counters, x, u);
  backend.synchronize();
  return {widened(download<T>(out)), widened(download<T>(energies)),
          widened(download<T>(first_values)), download<double>(counters), sum};
}

void check_equal(std::vector<double> const& got, std::vector<double> const& expected,
                 double tolerance) {
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    largest = std::max(largest, std::abs(expected[i]));
    // Written so that a NaN fails.
    if (!(std::abs(got[i] - expected[i]) <= difference))
      difference = std::abs(got[i] - expected[i]);
  }
  REQUIRE(largest > 0);
  CHECK(difference <= tolerance * largest);
}

template <class First, class Second, class T>
void compare(int n) {
  Scene<typename First::element> const scene(n);
  auto const expected = outcome<First, Second>(Reference<T>{}, scene);
  auto const got = outcome<First, Second>(Cuda<T>{}, scene);
  double const tolerance = sizeof(T) == 8 ? 1e-13 : 1e-5;
  auto expected_forces = expected.forces;
  expected_forces.resize(got.forces.size());
  check_equal(got.forces, expected_forces, tolerance);
  check_equal(got.energies, expected.energies, tolerance);
  CHECK(got.first_values == expected.first_values);
  CHECK(got.energy == Approx(expected.energy).epsilon(tolerance));
  CHECK(got.counters[0] == expected.counters[0]);
  CHECK(got.counters[1] == expected.counters[1]);
  CHECK(got.counters[2] == Approx(expected.counters[2]).epsilon(0.01));  // bounds round
}

template <class E, class Q>
void compare_laws(int n) {
  using Linear = Formulation<E, Q, Hooke>;
  using Green = Formulation<E, Q, SaintVenantKirchhoff>;
  using Log = Formulation<E, Q, NeoHookean>;
  compare<Linear, Green, float>(n);
  compare<Linear, Green, double>(n);
  compare<Log, Green, float>(n);
  compare<Log, Green, double>(n);
}

struct Square {
  double const* x;
  PLIANT_HOST_DEVICE double operator()(Index i) const { return x[i] * x[i]; }
};
struct AddOne {
  double* x;
  PLIANT_HOST_DEVICE void operator()(Index i) const { x[i] += 1; }
};

}  // namespace

TEST_CASE("forces, energies and visits on the GPU equal the reference", "[cuda]") {
  SECTION("Tri3") { compare_laws<Tri3, Gauss<1>>(20); }
  SECTION("Quad4") { compare_laws<Quad4, Gauss<2>>(20); }
  SECTION("Tet4") { compare_laws<Tet4, Gauss<1>>(6); }
  SECTION("Hex8") { compare_laws<Hex8, Gauss<2>>(7); }
}

TEST_CASE("large patches give the forces of small ones", "[cuda]") {
  using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  compare<F, F, float>(30);
  compare<F, F, double>(30);
}

TEST_CASE("elements of no group leave everything as it was", "[cuda]") {
  using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  Scene<Tet4> scene(3);
  std::ranges::fill(scene.tags, no_group);
  auto const got = outcome<F, F>(Cuda<double>{}, scene);
  for (double f : got.forces) CHECK(f == 0);
  CHECK(got.energy == 0);
  CHECK(got.counters == std::vector<double>{0, 0, 0});
}

/// Every second patch of a list, against tags that leave the others out.
template <class F, class T>
void compare_lists(int n) {
  Scene<typename F::element> const scene(n);
  using L = Laws<F, F, T>;
  constexpr int dim = F::dim;
  L const laws{{T(2), T(1)}, {T(3), T(2)}};
  Cuda<T> const backend;
  auto const made = [&](std::vector<Tag> const& tags) {
    return CudaElements<T, F::nodes>(backend, scene.connectivity, 2, tags, scene.nodes);
  };
  auto const all = made(scene.tags);
  REQUIRE(all.patch_count() > 2);
  std::vector<Index> list{0};
  std::vector<Tag> tags(scene.tags.size(), no_group);
  for (Index p = 0; p < all.patch_count(); p += 2) {
    list.push_back(p);
    for (Index e = p * all.patch_size(); e < std::min(all.count(), (p + 1) * all.patch_size()); ++e)
      tags[static_cast<std::size_t>(e)] = scene.tags[static_cast<std::size_t>(e)];
  }
  list[0] = static_cast<Index>(list.size()) - 1;
  auto const x = upload(backend, cast<T>(scene.rest)),
             u = upload(backend, cast<T>(scene.displacement));
  NodeField<T const, dim> const rest{x.data()}, displacement{u.data()};
  auto const forces = [&](auto const& table) {
    auto out = zeros<T>(backend, static_cast<std::size_t>(node_stride * scene.nodes));
    backend.template accumulate<2>(table, Force<L>{laws}, NodeField<T, dim>{out.data()}, rest,
                                   displacement);
    return widened(download<T>(out));
  };
  auto const numbers = upload(backend, list);
  auto const tagged = made(tags);
  check_equal(forces(over(all, numbers)), forces(tagged), sizeof(T) == 8 ? 1e-13 : 1e-5);
  CHECK(backend.template sum_elements<2>(over(all, numbers), Energy<L>{laws}, rest, displacement) ==
        Approx(backend.template sum_elements<2>(tagged, Energy<L>{laws}, rest, displacement))
            .epsilon(1e-6));
}

TEST_CASE("lists of patches pass over the others where elements scatter too", "[cuda]") {
  compare_lists<Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>, float>(7);
  compare_lists<Formulation<Hex8, Gauss<2>, SaintVenantKirchhoff>, double>(7);
  compare_lists<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>, float>(8);
  compare_lists<Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>, double>(8);
}

TEST_CASE("node loops reach every node once", "[cuda]") {
  Cuda<double> const backend;
  for (Index n : {0, 1, 31, 1000, 1 << 20}) {
    std::vector<double> values(static_cast<std::size_t>(n));
    double sum = 0, maximum = -std::numeric_limits<double>::infinity();
    for (Index i = 0; i < n; ++i) {
      double const x = values[static_cast<std::size_t>(i)] = std::sin(i + 1.0) - 2;
      sum += (x + 1) * (x + 1);
      maximum = std::max(maximum, (x + 1) * (x + 1));
    }
    auto array = upload(backend, values);
    backend.for_each(n, AddOne{array.data()});
    CHECK(backend.sum(n, Square{array.data()}) == test::Approx(sum).epsilon(1e-13));
    CHECK(backend.sum(n, Square{array.data()}) == backend.sum(n, Square{array.data()}));
    CHECK(backend.maximum(n, Square{array.data()}) == maximum);
  }
}

TEST_CASE("a recording does nothing until it is replayed", "[cuda]") {
  Cuda<double> const backend;
  auto array = zeros<double>(backend, 1000);
  auto const recording = backend.record([&] { backend.for_each(1000, AddOne{array.data()}); });
  CHECK(download<double>(array) == std::vector<double>(1000, 0));
  recording.replay(3);
  CHECK(download<double>(array) == std::vector<double>(1000, 3));
  CHECK_THROWS_AS(backend.record([&] { backend.sum(1000, Square{array.data()}); }), Error);
  backend.for_each(1000, AddOne{array.data()});
  CHECK(download<double>(array) == std::vector<double>(1000, 4));
}

TEST_CASE("backends of two GPUs take turns in one thread", "[cuda]") {
  int devices = 0;
  REQUIRE(cudaGetDeviceCount(&devices) == cudaSuccess);
  if (devices < 2) return;  // which half of it holds on one GPU, the next test checks
  using F = Formulation<Tet4, Gauss<1>, SaintVenantKirchhoff>;
  Scene<Tet4> const scene(6);
  auto const expected = outcome<F, F>(Reference<double>{}, scene);
  Cuda<double> const backends[] = {CudaOptions{.device = 0}, CudaOptions{.device = 1}};
  auto first = zeros<double>(backends[0], 100), second = zeros<double>(backends[1], 100);
  for (int round = 0; round < 3; ++round) {
    backends[0].for_each(100, AddOne{first.data()});
    backends[1].for_each(100, AddOne{second.data()});
    backends[1].for_each(100, AddOne{second.data()});
    for (auto const& backend : backends) {
      auto forces = outcome<F, F>(backend, scene).forces;
      check_equal(forces, expected.forces, 1e-13);
    }
  }
  CHECK(backends[0].sum(100, Square{first.data()}) == 900);
  CHECK(backends[1].sum(100, Square{second.data()}) == 3600);
  CHECK(download<double>(first) == std::vector<double>(100, 3));
  CHECK(download<double>(second) == std::vector<double>(100, 6));
}

TEST_CASE("verbs leave the current device of the thread as it was", "[cuda]") {
  int devices = 0, before = -1;
  REQUIRE(cudaGetDeviceCount(&devices) == cudaSuccess);
  for (int own = 0; own < std::min(devices, 2); ++own)
    for (int current = 0; current < std::min(devices, 2); ++current) {
      REQUIRE(cudaSetDevice(current) == cudaSuccess);
      auto const unchanged = [&] {
        return cudaGetDevice(&before) == cudaSuccess && before == current;
      };
      {
        Cuda<float> const backend{CudaOptions{.device = own}};
        CHECK(backend.device() == own);
        CHECK(unchanged());
        auto array = upload(backend, std::vector<double>(10, 1.0));
        CHECK(unchanged());
        auto const recording = backend.record([&] { backend.for_each(10, AddOne{array.data()}); });
        auto timer = backend.timer();
        timer.start();
        recording.replay(2);
        timer.stop();
        CHECK(unchanged());
        CHECK(timer.seconds() > 0);
        CHECK(backend.sum(10, Square{array.data()}) == 90);
        CHECK(unchanged());
        cudaPointerAttributes where{};
        REQUIRE(cudaPointerGetAttributes(&where, array.data()) == cudaSuccess);
        CHECK(where.device == own);
        CHECK(download<double>(array)[9] == 3);
      }
      CHECK(unchanged());
    }
  REQUIRE(cudaSetDevice(0) == cudaSuccess);
}

/// Keeps the GPU busy for a while, then writes.
struct WriteLate {
  double* x;
  double value;
  __device__ void operator()(Index i) const {
    long long const begin = clock64();
    while (clock64() - begin < 20'000'000) {
    }
    x[i] = value;
  }
};

TEST_CASE("copies come after the work of their backend and wait for no other stream", "[cuda]") {
  Cuda<double> const backend, other;
  auto array = zeros<double>(backend, 1), busy = zeros<double>(other, 1);
  // Long enough that a copy which waited for it would find it done.
  for (int k = 0; k < 50; ++k) other.for_each(1, WriteLate{busy.data(), 1});
  backend.for_each(1, WriteLate{array.data(), 7});

  CHECK(download<double>(array)[0] == 7);
  CHECK(cudaStreamQuery(other.stream()) == cudaErrorNotReady);
  array.upload(std::vector<double>{3});
  CHECK(backend.sum(1, Square{array.data()}) == 9);
  CHECK(cudaStreamQuery(other.stream()) == cudaErrorNotReady);
  cudaGetLastError();
  CHECK(download<double>(busy)[0] == 1);
}

TEST_CASE("values in pinned memory are read before a copy of them returns", "[cuda]") {
  Cuda<double> const backend;
  constexpr std::size_t count = 1 << 20;
  double* pinned = nullptr;
  REQUIRE(cudaMallocHost(&pinned, count * sizeof(double)) == cudaSuccess);
  auto array = zeros<double>(backend, count), busy = zeros<double>(backend, 1);
  std::fill_n(pinned, count, 1.0);
  backend.for_each(1, WriteLate{busy.data(), 1});

  array.upload(std::span<double const>(pinned, count));
  std::fill_n(pinned, count, 2.0);

  CHECK(download<double>(array) == std::vector<double>(count, 1.0));
  CHECK(cudaFreeHost(pinned) == cudaSuccess);
}

TEST_CASE("a backend queues its work on the stream that it is given", "[cuda]") {
  cudaStream_t stream = nullptr;
  REQUIRE(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking) == cudaSuccess);
  {
    Cuda<double> const backend{CudaOptions{.stream = stream}};
    CHECK(backend.stream() == stream);
    auto array = zeros<double>(backend, 1);
    backend.for_each(1, WriteLate{array.data(), 7});
    double value = 0;
    cudaMemcpyAsync(&value, array.data(), sizeof value, cudaMemcpyDeviceToHost, stream);
    REQUIRE(cudaStreamSynchronize(stream) == cudaSuccess);
    CHECK(value == 7);
  }
  CHECK(cudaStreamDestroy(stream) == cudaSuccess);  // the backend left it alone
}

TEST_CASE("timers add what they measured, however many measurements there were", "[cuda]") {
  Cuda<double> const backend;
  auto array = zeros<double>(backend, 1);
  auto all = backend.timer(), each = backend.timer();
  all.start();
  for (int k = 0; k < 600; ++k) {
    each.start();
    backend.for_each(1, AddOne{array.data()});
    each.stop();
  }
  all.stop();
  CHECK(each.seconds() > 0);
  CHECK(each.seconds() <= all.seconds());
  CHECK(each.seconds() == each.seconds());
}

TEST_CASE("a measurement that was not stopped is dropped", "[cuda]") {
  Cuda<double> const backend;
  auto array = zeros<double>(backend, 1000);
  auto timer = backend.timer();
  timer.stop();
  timer.start();
  CHECK(timer.seconds() == 0);
  for (int k = 0; k < 600; ++k) {
    timer.start();
    backend.for_each(1000, AddOne{array.data()});
    if (k % 2 == 0) timer.stop();
  }
  CHECK(timer.seconds() > 0);
  timer.start();
  timer.stop();
  CHECK(timer.seconds() > 0);
}

TEST_CASE("a recording keeps what its verbs use when the backend is gone", "[cuda]") {
  Cuda<double> const other;
  CudaRecording recording;
  auto sum = zeros<double>(other, 1), array = upload(other, std::vector<double>(100000, 2));
  {
    Cuda<double> const backend;
    recording = backend.record([&] { backend.add_sum(100000, Square{array.data()}, sum.data()); });
  }
  auto const taken = zeros<double>(other, detail::CudaContext::max_partials);
  other.synchronize();
  recording.replay(2);
  cudaDeviceSynchronize();
  CHECK(download<double>(sum)[0] == 8e5);
  CHECK(download<double>(taken) == std::vector<double>(detail::CudaContext::max_partials, 0));
}

TEST_CASE("patches that a GPU has no room for are made smaller", "[cuda]") {
  // Elements that share no node need most.
  std::vector<std::array<Index, 4>> connectivity;
  for (Index e = 0; e < 5000; ++e) connectivity.push_back({4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3});
  std::vector<Tag> const tags(connectivity.size(), Tag(0));
  Cuda<double> const backend;
  constexpr int small = detail::patch_tuning<double, 4>().small_size;
  CudaElements<double, 4> const large(backend, connectivity, tags, 20000, {2048, 256});
  CHECK(large.patch_size() == small);
  CHECK(large.threads() == small);
  CudaElements<double, 4> const huge(backend, connectivity, tags, 20000, {65536, 256});
  CHECK(huge.patch_size() == small);
  CudaElements<double, 4> const fits(backend, connectivity, tags, 20000, {128, 128});
  CHECK(fits.patch_size() == 128);
}

TEST_CASE("a kernel keeps the shared memory that it was allowed", "[cuda]") {
  auto const kernel = reinterpret_cast<void const*>(detail::call_for_each<AddOne>);
  auto const allowed = [&] {
    cudaFuncAttributes attributes{};
    REQUIRE(cudaFuncGetAttributes(&attributes, kernel) == cudaSuccess);
    return attributes.maxDynamicSharedSizeBytes;
  };
  detail::allow_shared_bytes(kernel, 80 << 10, "test");
  detail::allow_shared_bytes(kernel, 60 << 10, "test");
  CHECK(allowed() == 80 << 10);
  CHECK_THROWS_AS(detail::allow_shared_bytes(kernel, 1 << 20, "test"), Error);
}

TEST_CASE("too large an array is refused with the numbers of bytes", "[cuda]") {
  std::string message;
  try {
    zeros<double>(Cuda<float>{}, std::size_t{1} << 45);
  } catch (Error const& error) {
    message = error.what();
  }
  CHECK(message.find("out of memory") != std::string::npos);
  CHECK(message.find("281474976710656 bytes was asked for") != std::string::npos);
  CHECK_THROWS_AS(zeros<double>(Cuda<float>{}, std::size_t{1} << 61), Error);
  CHECK_THROWS_AS(Cuda<float>(CudaOptions{.device = 99}), Error);
}

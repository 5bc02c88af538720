// Long runs of random events; see storm.hpp.
//
//   storm [STEPS] [--seed N] [--cells N] [--ledger] [--scene NAME]
//
//   STEPS         of each scene on each backend; 2000 when not said
//   --seed N      of the random numbers; 1 when not said
//   --cells N     along the edges of meshes; few when not said, too few for several threads
//   --ledger      leave out what the energy ledger does not know, and check that it closes
//   --scene NAME  plane, types, tetrahedra or hexahedra alone

#include <cstdio>
#include <cstdlib>
#include <string>

#include "storm/scenes.hpp"

namespace {

using namespace pliant;

bool failed = false;

template <class Scene>
void run(char const* name, Scene scene, storm::Options const& options) {
  storm::Storm<Scene> storm(std::move(scene), options);
  try {
    auto const r = storm.run();
    std::printf(
        "%-28s %lld steps, %lld of them local, %lld epochs, %lld restarts, %lld roll-backs, %lld "
        "refused, %lld drives, "
        "%lld pressures, %.0f switches, sleep in %lld epochs, up to %lld nodes, ledger within "
        "%.1e\n",
        name, static_cast<long long>(r.steps), static_cast<long long>(r.local),
        static_cast<long long>(r.epochs), static_cast<long long>(r.restarts),
        static_cast<long long>(r.retries), static_cast<long long>(r.refused),
        static_cast<long long>(r.driven), static_cast<long long>(r.pressed), r.switched,
        static_cast<long long>(r.slept), static_cast<long long>(r.largest_mesh),
        r.worst_ledger_error);
    for (auto const& [event, missed] : r.missed)
      std::printf("  the ledger misses %.1e of the largest energy in events \"%s\"\n", missed,
                  event.c_str());
    if (!(r.worst_ledger_error < 1e-3)) throw storm::Failure("the ledger does not close");
  } catch (std::exception const& error) {
    failed = true;
    std::printf("%-28s FAILED (%s): %s\n", name, storm.where().c_str(), error.what());
  }
  std::fflush(stdout);
}

template <Backend B>
void run_on(B const& backend, std::string const& scene, storm::Options options) {
  using Relaxing = Prony<NeoHookean>::law<double>;
  auto const called = [&](char const* name) { return std::string(B::name()) + ", " + name; };
  if (scene.empty() || scene == "plane")
    run(called("plane").c_str(),
        storm::Plane<B>{backend, options.seed, options.cells ? options.cells : 5}, options);
  if (scene.empty() || scene == "types")
    run(called("types").c_str(),
        storm::Types<B>{backend, options.seed, options.cells ? options.cells : 6}, options);
  if (scene.empty() || scene == "tetrahedra")
    run(called("tetrahedra").c_str(),
        storm::Solid<B, Tet4, NeoHookean>{
            backend, {}, options.seed, options.cells ? options.cells : 4},
        options);
  // Laws with internal variables dissipate.
  if (!options.ledger && (scene.empty() || scene == "hexahedra"))
    run(called("hexahedra").c_str(),
        storm::Solid<B, Hex8, Prony<NeoHookean>::law>{
            backend,
            {Relaxing{NeoHookean<double>::from(storm::soft), {0.4}, {2.0}}},
            options.seed,
            options.cells ? options.cells : 4},
        options);
}

}  // namespace

int main(int count, char** arguments) {
  storm::Options options;
  std::string scene;
  for (int k = 1; k < count; ++k) {
    std::string const argument = arguments[k];
    if (argument == "--ledger")
      options.ledger = true;
    else if (argument == "--seed" && k + 1 < count)
      options.seed = static_cast<unsigned>(std::strtoul(arguments[++k], nullptr, 10));
    else if (argument == "--cells" && k + 1 < count)
      options.cells = static_cast<int>(std::strtol(arguments[++k], nullptr, 10));
    else if (argument == "--scene" && k + 1 < count)
      scene = arguments[++k];
    else if (char* end = nullptr; std::strtoll(argument.c_str(), &end, 10) > 0 && *end == '\0')
      options.steps = std::strtoll(argument.c_str(), nullptr, 10);
    else {
      std::fprintf(stderr, "storm: don't know '%s'; see main.cpp\n", argument.c_str());
      return 2;
    }
  }
#if defined(STORM_ON_MAIN_BACKEND)
  using Backends = test::MainAlone;
#else
  using Backends = test::Backends<double>;
#endif
  std::apply([&](auto const&... backend) { (run_on(backend, scene, options), ...); }, Backends{});
  return failed ? 1 : 0;
}

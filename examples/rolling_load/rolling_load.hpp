#pragma once

#include <chrono>
#include <cstdio>
#include <numeric>

#include <pliant/pliant.hpp>
#include <pliant/solve.hpp>

#include "picture/film.hpp"
#include "scene/carve.hpp"
#include "scene/options.hpp"
#include "scene/solid_drawing.hpp"

// A load rolls over a block with a notch in its bottom, in small steps. After each, elements that contribute more than a tolerance to
// the energy of the error, as they do under the load, are refined; behind it they are merged again.
namespace rolling_load {

using namespace pliant;

using F = Formulation<Hex8, Gauss<2>, Hooke>;

inline constexpr Elastic steel{.young = 2e11, .poisson = 0.3, .density = 7.8e3};  // Pa, -, kg/m³
inline constexpr double length = 4;                                               // m
inline constexpr double patch = 0.3;                          // m: half the width of the load
inline constexpr double peak = 5e6;                           // Pa: in the middle of the load
inline constexpr double first_place = 0.5, last_place = 3.5;  // m: where the load stands
inline constexpr int places = 26;
inline constexpr int drawn_apart = 5;   // of them in the strip
inline constexpr int first_rounds = 4;  // of adaptation, at the first place; one at each other
inline constexpr int max_level = 3;
inline constexpr int uniform_level = 2;
inline constexpr double magnified = 2e3;

/// The block without its notch, n cells high.
inline Mesh<Hex8> block(int n) {
  auto const is_notch = [n](Point<3> const& middle) {
    return std::abs(middle[0] - length / 2) < 0.6 / n && middle[2] < 0.5;
  };
  auto mesh = scene::carve(mesh::box({.size = {length, 1, 1}, .cells = {4 * n, n, n}}), is_notch);
  mesh.boundaries["top"] =
      mesh::outer_sides_where(mesh, [](Point<3> const& p) { return p[2] == 1; });
  mesh.boundaries["feet"] = mesh::outer_sides_where(mesh, [n](Point<3> const& p) {
    double const foot = 1.0 / n;
    return p[2] == 0 && (p[0] <= foot || p[0] >= length - foot);
  });
  return mesh;
}

/// Of the load at one place: what it took, and what was left of the error.
struct Answer {
  double seconds = 0;  // to solve, and to adapt the mesh
  std::size_t elements = 0, nodes = 0;
  long unknowns = 0;
  double error = 0;  // energy norm, share of the solution's

  void operator+=(Answer const& other) {
    seconds += other.seconds;
    unknowns += other.unknowns;
  }
};

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

template <class TheBody>
void refine_all(TheBody& body) {
  std::vector<Index> all(body.mesh().template elements<Hex8>().size());
  std::iota(all.begin(), all.end(), 0);
  refine(body, {all});
}

template <class TheBody>
NewtonReport solve_at(TheBody& body, double place) {
  body.set_loads(
      traction_loads(body.mesh(), body.mesh().boundary("top"), [place](Point<3> const& p) {
        double const from = (p[0] - place) / patch;
        return Point<3>{0, 0, -peak * std::max(0.0, 1 - from * from)};
      }));
  return solve_static(body);
}

/// Moves the load to a place.
template <class TheBody>
Answer move_to(TheBody& body, double place) {
  auto const begin = std::chrono::steady_clock::now();
  auto const report = solve_at(body, place);
  double const seconds = seconds_since(begin);
  return {.seconds = seconds,
          .elements = body.mesh().template elements<Hex8>().size(),
          .nodes = body.mesh().nodes.size(),
          .unknowns = report.unknowns,
          .error = std::sqrt(estimate(body, RecoveredStress{}) / report.energy)};
}

/// Elements that contribute more than so much to the error's energy are refined. As long as the field is smooth an element's
/// share falls to 1/32 when it becomes eight: merging asks for less than 0.8 of the tolerance afterwards.
inline auto follow(double tolerance) {
  return Adaptation{when<F>(RecoveredStress{}).above(tolerance).refine({.max_level = max_level}),
                    when<F>(RecoveredStress{}).below(tolerance / 40).coarsen()};
}

/// The mean level of the upper elements whose distance from the load, along the block, is within a range.
template <class TheBody>
double mean_level(TheBody const& body, double place, double nearest, double farthest) {
  auto const levels = refinement_levels<Hex8>(body);
  auto const& elements = body.mesh().template elements<Hex8>();
  double sum = 0, count = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    auto const& corner = body.mesh().nodes[static_cast<std::size_t>(elements[e][0])];
    double const away = std::abs(corner[0] - place);
    if (corner[2] < 0.7 || away < nearest || away > farthest) continue;
    sum += levels[e];
    ++count;
  }
  return sum / std::max(count, 1.0);
}

/// The block, coloured by level, and an arrow at the node of its top that is nearest to the load.
template <class TheBody>
picture::Frame draw(TheBody const& body, double place) {
  auto const levels = refinement_levels<Hex8>(body);
  auto frame = scene::draw_solid<Hex8>(
      body, body.mesh().boundary("skin"), magnified,
      [&](std::size_t e) { return picture::green_to_red(double(levels[e]) / max_level); });
  auto const top = nodes_of(body.mesh().boundary("top"));
  auto const away = [&](Index node) {
    auto const& p = body.mesh().nodes[static_cast<std::size_t>(node)];
    return std::hypot(p[0] - place, p[1] - 0.5);
  };
  auto const nearest = static_cast<std::size_t>(*std::ranges::min_element(top, {}, away));
  auto const tip = picture::Eye{}.project(scene::displaced(body, magnified)[nearest]);
  frame.polygons.push_back(picture::arrow_down(tip, 0.4, picture::blue));
  return frame;
}

inline void print(double place, Answer const& own, Answer const& other) {
  std::printf("%6.2f | %9zu %9ld %7.2f%% %7.3f | %9zu %9ld %7.2f%% %7.3f\n", place, own.elements,
              own.unknowns, 100 * own.error, own.seconds, other.elements, other.unknowns,
              100 * other.error, other.seconds);
  std::fflush(stdout);
}

inline void check(bool holds, double place, char const* what) {
  if (!holds) throw Error("rolling load: with the load at ", place, " m ", what);
}

/// All places as a film, and some of them as a strip.
struct Pictures {
  std::vector<picture::Frame> film{}, strip{};

  void add(picture::Frame frame, double place, Answer const& own, Answer const& other) {
    char caption[128];
    if (film.size() % drawn_apart == 0) {
      std::snprintf(caption, sizeof caption,
                    "(%c) %zu elements, error %.1f %%, %.2f s\nuniform: %zu, %.1f %%, %.2f s",
                    static_cast<char>('a' + strip.size()), own.elements, 100 * own.error,
                    own.seconds, other.elements, 100 * other.error, other.seconds);
      frame.caption = caption;
      strip.push_back(frame);
    }
    std::snprintf(caption, sizeof caption, "load at %.1f m: %zu elements, %zu nodes, %.2f s", place,
                  own.elements, own.nodes, own.seconds);
    frame.caption = caption;
    film.push_back(std::move(frame));
  }

  void write(std::filesystem::path const& folder) const {
    picture::Options look{.title = "The mesh follows a load that rolls over a block",
                          .columns = 2,
                          .colour_bar = {.label = "level", .lowest = 0, .highest = max_level},
                          .legend = {{"load", picture::blue}},
                          .length_unit = "m"};
    auto const path = folder / "rolling_load.png";
    picture::write_strip(path, strip, look);
    std::printf("picture: %s\n", path.string().c_str());
    look.title = "The mesh follows a rolling load";
    picture::write_film(folder / "film", film, look);
  }
};

template <class TheBackend>
void run(TheBackend const& backend, scene::Options const& options) {
  int const cells = options.cells > 0 ? options.cells : 4;
  auto const made = [&](Mesh<Hex8> const& mesh) {
    Body body{backend, mesh, steel, Group<F>{}};
    body.clamp(mesh.boundary("feet"));
    return body;
  };
  auto adaptive = made(block(cells));
  auto uniform = made(block(cells));
  for (int level = 0; level < uniform_level; ++level) refine_all(uniform);
  auto adapt = follow(1.2e-3 * std::pow(4.0 / cells, 5));  // J

  std::printf("Rolling load on %s: a notched block of 4 m x 1 m x 1 m, Hex8\n", TheBackend::name());
  std::printf("%6s | %9s %9s %8s %7s | %9s %9s %8s %7s\n", "load/m", "adaptive", "unknowns",
              "error", "s", "uniform", "unknowns", "error", "s");
  // The first solution of each body also builds what later ones reuse, and the first mesh has to be found.
  auto const begin = std::chrono::steady_clock::now();
  for (int round = 0; round < first_rounds; ++round) {
    solve_at(adaptive, first_place);
    adapt.now(adaptive);
  }
  Answer sum{.seconds = seconds_since(begin)}, uniform_sum;
  Pictures pictures;
  for (int k = 0; k < places; ++k) {
    double const place = first_place + (last_place - first_place) * k / (places - 1);
    auto own = move_to(adaptive, place);
    auto const other = move_to(uniform, place);
    auto frame = draw(adaptive, place);
    // The tolerance was chosen for the scene's own cells.
    check(options.cells > 0 || own.error < 1.1 * other.error, place,
          "the error on the adaptive mesh exceeds that on the uniform one by a tenth");
    check(mean_level(adaptive, place, 0, patch) > mean_level(adaptive, place, 4 * patch, length),
          place, "the mesh under it is no finer than far from it");
    auto const before = std::chrono::steady_clock::now();
    adapt.now(adaptive);
    own.seconds += seconds_since(before);
    print(place, own, other);
    sum += own;
    uniform_sum += other;
    pictures.add(std::move(frame), place, own, other);
  }
  check(2 * sum.unknowns < uniform_sum.unknowns, last_place,
        "the adaptive meshes took more than half of the uniform's unknowns");
  std::printf(
      "all places: %.2f s adaptive, the first mesh and all adaptation counted, %.2f s on the "
      "uniform mesh: %.2f of the time with %.2f of the unknowns\n",
      sum.seconds, uniform_sum.seconds, sum.seconds / uniform_sum.seconds,
      double(sum.unknowns) / double(uniform_sum.unknowns));
  pictures.write(options.output);
}

}  // namespace rolling_load

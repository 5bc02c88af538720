#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <catch2/catch.hpp>

#include <pliant/reference.hpp>

#include "film.hpp"
#include "scene/solid_drawing.hpp"
#include "solid.hpp"
#include "strip.hpp"

namespace {

using namespace pliant::picture;

// A name of its own, since tests may run side by side.
class TemporaryFile {
 public:
  TemporaryFile()
      : path_(std::filesystem::temp_directory_path() /
              ("pliant_picture_" + std::to_string(std::random_device{}()) + ".png")) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFile(TemporaryFile const&) = delete;
  TemporaryFile& operator=(TemporaryFile const&) = delete;

  std::filesystem::path const& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// A PNG file begins with eight fixed bytes, and its header holds width and height at byte 16.
struct PngSize {
  int width, height;
};

PngSize read_png_size(std::filesystem::path const& path) {
  std::array<char, 24> bytes{};
  REQUIRE(std::ifstream(path, std::ios::binary).read(bytes.data(), bytes.size()));
  REQUIRE(std::string(bytes.data(), 8) == "\x89PNG\r\n\x1a\n");
  auto const read_int = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
      value = 256 * value + static_cast<unsigned char>(bytes[i]);
    }
    return value;
  };
  return {read_int(16), read_int(20)};
}

Frame make_rectangle(double width, double height) {
  Frame frame;
  frame.polygons.push_back({{{0, 0}, {width, 0}, {width, height}, {0, height}}, green_to_red(0.2)});
  frame.caption = "a rectangle";
  return frame;
}

PngSize draw(std::vector<Frame> const& frames, Options const& options = {}) {
  TemporaryFile const file;
  write_strip(file.path(), frames, options);
  return read_png_size(file.path());
}

std::string complaint(std::vector<Frame> const& frames, Options const& options = {}) {
  TemporaryFile const file;
  std::string message;
  try {
    write_strip(file.path(), frames, options);
  } catch (std::runtime_error const& error) {
    message = error.what();
  }
  CHECK_FALSE(std::filesystem::exists(file.path()));
  return message;
}

std::string read(std::filesystem::path const& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string drawn(Frame const& frame) {
  TemporaryFile const file;
  write_strip(file.path(), std::vector{frame});
  return read(file.path());
}

// The sides of a cube of side 1, seen from outside, each of another red.
std::vector<SolidFacet> make_cube(Point3 const& corner) {
  std::vector<SolidFacet> facets;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (double const end : {0.0, 1.0}) {
      SolidFacet facet{{}, {0.5 + 0.1 * static_cast<double>(facets.size()), 0, 0}};
      for (auto const& [a, b] : {std::array{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        Point3 p = corner;
        p[axis] += end;
        p[(axis + 1) % 3] += end > 0 ? a : b;
        p[(axis + 2) % 3] += end > 0 ? b : a;
        facet.corners.push_back(p);
      }
      facets.push_back(facet);
    }
  return facets;
}

double area(SolidFacet const& facet) {  // of a rectangle
  auto const side = [&](std::size_t to) {
    auto const &p = facet.corners[0], &q = facet.corners[to];
    return std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
  };
  return side(1) * side(3);
}

bool mentions(std::string const& message, std::string const& words) {
  UNSCOPED_INFO(message);
  return message.find(words) != std::string::npos;
}

double constexpr not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("green_to_red goes from green through yellow to red and stays there", "[picture]") {
  auto const [low, middle, high] = std::array{green_to_red(0), green_to_red(0.5), green_to_red(1)};
  CHECK(low.g > 2 * low.r);
  CHECK((middle.r > 0.8 && middle.g > 0.8 && middle.b < 0.5));
  CHECK(high.r > 4 * high.g);
  CHECK(green_to_red(-3).g == low.g);
  CHECK(green_to_red(7).r == high.r);
  for (int i = 0; i < 100; ++i) {
    auto const here = green_to_red(0.01 * i);
    auto const next = green_to_red(0.01 * (i + 1));
    CHECK(next.r - next.g > here.r - here.g);
  }
}

TEST_CASE("A strip fills about 1800 pixels and takes its height from the mesh", "[picture]") {
  auto const flat = draw(std::vector(3, make_rectangle(10, 1)), {.columns = 3});
  auto const square = draw(std::vector(3, make_rectangle(10, 10)), {.columns = 3});
  CHECK(flat.width > 1700);
  CHECK(flat.width <= 1800);
  CHECK(square.width == flat.width);
  // Nine tenths of a third of the width, less what lies between the frames.
  CHECK(square.height - flat.height > 0.25 * flat.width);
  CHECK(square.height - flat.height < 0.30 * flat.width);
}

TEST_CASE("Every row, title, caption line and legend adds to the height", "[picture]") {
  std::vector const frames(4, make_rectangle(2, 1));
  Options const plain{.columns = 4, .frame_width = 400, .frame_height = 200};
  auto const size = draw(frames, plain);

  auto narrow = plain;
  narrow.columns = 2;
  CHECK(draw(frames, narrow).height > size.height + 200);
  CHECK(draw(frames, narrow).width < size.width - 800);

  auto titled = plain;
  titled.title = "A title";
  CHECK(draw(frames, titled).height > size.height);

  auto captioned = frames;
  captioned[2].caption = "a caption that is so long that it cannot stay on one line of one frame";
  CHECK(draw(captioned, plain).height > size.height);
  CHECK(draw(captioned, plain).width == size.width);

  auto explained = plain;
  explained.colour_bar.label = "max(R_L, R_A)";
  CHECK(draw(frames, explained).height > size.height);
}

TEST_CASE("A very tall mesh does not make a very tall picture", "[picture]") {
  CHECK(draw({make_rectangle(1, 50)}).height < 1300);
}

TEST_CASE("What cannot be drawn is named, and no file is left", "[picture]") {
  std::vector const good(3, make_rectangle(2, 1));

  SECTION("no frames") { CHECK(mentions(complaint({}), "no polygon")); }
  SECTION("no polygons") { CHECK(mentions(complaint({Frame{}, Frame{}}), "no polygon")); }
  SECTION("a corner that is not a number") {
    auto bad = good;
    bad[1].polygons[0].corners[2][1] = not_a_number;
    CHECK(mentions(complaint(bad), "frame 1, polygon 0"));
  }
  SECTION("a clamp that is not finite") {
    auto bad = good;
    bad[2].clamps.push_back({{{0, 0}, {0, std::numeric_limits<double>::infinity()}}});
    CHECK(mentions(complaint(bad), "frame 2, clamp 0"));
  }
  SECTION("a criterion that is not a number") {
    auto bad = good;
    bad[0].polygons[0].fill = green_to_red(not_a_number);
    CHECK(mentions(complaint(bad), "frame 0, polygon 0"));
  }
  SECTION("two corners") {
    auto bad = good;
    bad[0].polygons[0].corners.resize(2);
    CHECK(mentions(complaint(bad), "2 corners"));
  }
  SECTION("no extent") { CHECK(mentions(complaint({make_rectangle(0, 0)}), "finite size")); }
  SECTION("negative pixels") { CHECK(mentions(complaint(good, {.frame_width = -1}), "negative")); }
  SECTION("more pixels than a picture may have") {
    CHECK(mentions(complaint(good, {.columns = 3, .frame_width = 20000}), "pixels"));
  }
}

TEST_CASE("A path that cannot be written to is named", "[picture]") {
  auto const path = std::filesystem::temp_directory_path() / "pliant_no_such_folder" / "a.png";
  std::vector const frames{make_rectangle(2, 1)};
  std::string message;
  try {
    write_strip(path, frames);
  } catch (std::runtime_error const& error) {
    message = error.what();
  }
  CHECK(mentions(message, path.string()));
  CHECK(mentions(message, "folder"));
}

TEST_CASE("An eye from the front sees x to the right and z upwards", "[picture]") {
  Eye const front{.turn = 0, .tilt = 0};
  CHECK(front.project({2, 5, 3}) == Point{2, 3});
  CHECK(front.depth({0, -1, 0}) > front.depth({0, 1, 0}));
}

TEST_CASE("A view keeps lengths across it, and depth is what it takes away", "[picture]") {
  Eye const eye{.turn = 0.7, .tilt = -0.3};
  Point3 const p{0.3, -1.2, 2};
  auto const [x, y] = eye.project(p);
  CHECK(std::hypot(x, y, eye.depth(p)) == Approx(std::hypot(p[0], p[1], p[2])));
  CHECK(eye.depth(eye.towards()) == Approx(1));
}

TEST_CASE("Of a cube only the sides that look at the eye are seen, darker when seen askew",
          "[picture]") {
  auto const facets = make_cube({0, 0, 0});
  auto const &left = facets[0], &right = facets[1], &front = facets[2], &top = facets[5];
  CHECK(project(std::vector{left}).empty());
  CHECK(project(facets).size() == 3);
  auto const light = [](SolidFacet const& facet, Eye const& eye) {
    return project(std::vector{facet}, eye).at(0).fill.r / facet.fill.r;
  };
  double const upright = std::acos(0);
  CHECK(light(top, {.turn = 0, .tilt = upright}) == Approx(1));
  CHECK(light(front, {.turn = 0, .tilt = 0}) == Approx(1));
  CHECK(light(right, {.turn = -upright, .tilt = 0}) == Approx(1));
  CHECK(light(front, {.turn = 0, .tilt = 1}) < light(front, {.turn = 0, .tilt = 0.5}));
}

TEST_CASE("What is nearer is drawn later, wherever it stands in the list", "[picture]") {
  auto const near = make_cube({0, 0, 0});
  auto far = make_cube({0.3, 2, 0});
  for (auto& facet : far) facet.fill.g = 1;
  auto const is_far = [](Polygon const& polygon) { return polygon.fill.g > 0; };
  auto near_first = near, far_first = far;
  near_first.insert(near_first.end(), far.begin(), far.end());
  far_first.insert(far_first.end(), near.begin(), near.end());
  for (auto const& facets : {near_first, far_first}) {
    auto const polygons = project(facets);
    REQUIRE(polygons.size() == 6);
    CHECK(std::ranges::all_of(polygons.begin(), polygons.begin() + 3, is_far));
    CHECK(std::ranges::none_of(polygons.begin() + 3, polygons.end(), is_far));
  }
}

TEST_CASE("In a stacked frame what is covered leaves no trace, edges included", "[picture]") {
  auto cover = make_rectangle(2, 1);
  auto covering = cover;
  Polygon const small{{{0.5, 0.3}, {1.5, 0.3}, {1.5, 0.7}, {0.5, 0.7}}, blue};
  covering.polygons.insert(covering.polygons.begin(), small);
  CHECK(drawn(covering) != drawn(cover));
  cover.layers = covering.layers = Layers::stacked;
  CHECK(drawn(covering) == drawn(cover));
}

TEST_CASE("A polygon that covers no other is drawn alike, stacked or flat", "[picture]") {
  auto const flat = make_rectangle(2, 1);
  auto stacked = flat;
  stacked.layers = Layers::stacked;
  CHECK(drawn(stacked) == drawn(flat));
}

TEST_CASE("Of a refined solid no facet between elements is drawn, hanging or not", "[picture]") {
  using namespace pliant;
  using F = Formulation<Hex8, Gauss<2>, Hooke>;
  auto mesh = mesh::box({.size = {2, 1, 1}, .cells = {2, 1, 1}});
  mesh.boundaries["skin"] = mesh::outer_sides(mesh);
  Body body{Reference<double>{}, mesh, Elastic{.young = 1, .poisson = 0.3, .density = 1},
            Group<F>{}};
  refine(body, {{0}});
  auto const levels = refinement_levels<Hex8>(body);

  auto const facets =
      scene::solid_facets<Hex8>(body, body.mesh().boundary("skin"), 1,
                                [&](std::size_t e) { return green_to_red(levels[e]); });

  CHECK(facets.size() == 5 + 5 * 4);
  double sum = 0;
  for (auto const& facet : facets) {
    sum += area(facet);
    bool const is_between = std::ranges::all_of(facet.corners, [](auto& p) { return p[0] == 1; });
    CHECK_FALSE(is_between);
    CHECK(facet.fill.g == green_to_red(area(facet) < 1 ? 1 : 0).g);
  }
  CHECK(sum == Approx(10));
}

TEST_CASE("Displacements of a solid are drawn magnified", "[picture]") {
  using namespace pliant;
  auto const mesh = mesh::box({.size = {1, 1, 1}, .cells = {1, 1, 1}});
  Body body{Reference<double>{}, mesh, Elastic{.young = 1, .poisson = 0.3, .density = 1},
            Group<Formulation<Hex8, Gauss<2>, Hooke>>{}};
  std::vector<pliant::Point<3>> u(mesh.nodes.size(), {0.01, 0, -0.02});
  body.set_displacements(u);
  auto const places = scene::displaced(body, 10);
  CHECK(places[3][0] == Approx(mesh.nodes[3][0] + 0.1));
  CHECK(places[3][2] == Approx(mesh.nodes[3][2] - 0.2));
}

TEST_CASE("The pictures of a film have one size, and a shorter film leaves none of a longer one",
          "[picture]") {
  TemporaryFile const folder;
  std::vector frames{make_rectangle(2, 1), make_rectangle(1, 3), make_rectangle(0.5, 0.5)};
  frames[1].caption =
      "a caption that is so long that it cannot stay on one line of one frame of it";
  write_film(folder.path(), frames);
  auto const first = read_png_size(folder.path() / "0000.png");
  for (char const* name : {"0001.png", "0002.png"}) {
    auto const other = read_png_size(folder.path() / name);
    CHECK((other.width == first.width && other.height == first.height));
  }
  frames.pop_back();
  write_film(folder.path(), frames);
  CHECK(std::filesystem::exists(folder.path() / "0001.png"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "0002.png"));
}

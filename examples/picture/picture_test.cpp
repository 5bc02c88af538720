#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <catch2/catch.hpp>

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
    std::filesystem::remove(path_, ignored);
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

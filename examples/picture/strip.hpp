#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "colour.hpp"
#include "frame.hpp"

namespace pliant::picture {

struct LegendEntry {
  std::string label;
  Colour colour;
};

/// What `green_to_red` stands for. No label, no bar.
struct ColourBar {
  std::string label{};
  double lowest = 0;   ///< the number written at the green end
  double highest = 1;  ///< the number written at the red end
};

/// How a strip looks. In every text a single letter, an underscore and letters or digits make a
/// symbol with a subscript: "max(R_L, R_A)".
struct Options {
  std::string title{};
  int columns = 0;       ///< 0: whatever makes the picture about as wide as a page is
  int frame_width = 0;   ///< pixels; 0: so that the picture is about 1800 wide
  int frame_height = 0;  ///< pixels; 0: what each row's meshes need, 1000 at most
  ColourBar colour_bar{};
  std::vector<LegendEntry> legend{};
  std::string length_unit{};  ///< such as "m": draws a bar of a round length; empty: none
};

/// Draws the frames, row by row and all to one scale, into a PNG file.
/// Throws std::runtime_error where there is nothing to draw, where a coordinate or a colour is not
/// finite, where the picture would be too large, and where the file cannot be written; all but the
/// last before the file is touched.
void write_strip(std::filesystem::path const& path, std::span<Frame const> frames,
                 Options const& options = {});

}  // namespace pliant::picture

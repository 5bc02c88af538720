#pragma once

#include <filesystem>
#include <span>

#include "strip.hpp"

namespace pliant::picture {

/// Draws each frame into a PNG file of its own, 0000.png and on in a folder that is made where it is missing; all
/// to one scale and of one size. Files that a longer film left there are removed. `examples/run` joins them.
/// Throws what `write_strip` does.
void write_film(std::filesystem::path const& folder, std::span<Frame const> frames,
                Options const& options = {});

}  // namespace pliant::picture

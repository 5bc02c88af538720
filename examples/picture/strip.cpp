#include "strip.hpp"

#include "sheet.hpp"

namespace pliant::picture {

void write_strip(std::filesystem::path const& path, std::span<Frame const> frames,
                 Options const& options) {
  Sheet{frames, options, Sheets::one}.write(path, 0, frames.size());
}

}  // namespace pliant::picture

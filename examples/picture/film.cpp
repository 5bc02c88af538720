#include "film.hpp"

#include <cstddef>
#include <cstdio>

#include "sheet.hpp"
#include "style.hpp"

namespace pliant::picture {

void write_film(std::filesystem::path const& folder, std::span<Frame const> frames,
                Options const& options) {
  auto one_each = options;
  one_each.columns = 1;
  if (one_each.frame_width == 0) one_each.frame_width = style::film_width;
  Sheet const sheet{frames, one_each, Sheets::many};
  std::filesystem::create_directories(folder);
  auto const name = [&](std::size_t frame) {
    char number[32];
    std::snprintf(number, sizeof number, "%04zu.png", frame);
    return folder / number;
  };
  for (std::size_t f = 0; f < frames.size(); ++f) sheet.write(name(f), f, 1);
  for (auto f = frames.size(); std::filesystem::remove(name(f)); ++f) {
  }
}

}  // namespace pliant::picture

#include "colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pliant::picture {

Colour green_to_red(double value) {
  if (std::isnan(value)) return {value, value, value};
  // Darker than pure colours, so that they print, and evenly spaced to the eye.
  static std::array<Colour, 5> constexpr stops{{{0.10, 0.60, 0.29},
                                                {0.56, 0.79, 0.33},
                                                {1.00, 0.89, 0.36},
                                                {0.97, 0.54, 0.23},
                                                {0.82, 0.12, 0.14}}};
  double const place = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  auto const below = place >= stops.size() - 1 ? stops.size() - 2 : static_cast<std::size_t>(place);
  auto const& a = stops[below];
  auto const& b = stops[below + 1];
  double const part = place - static_cast<double>(below);
  return {std::lerp(a.r, b.r, part), std::lerp(a.g, b.g, part), std::lerp(a.b, b.b, part)};
}

}  // namespace pliant::picture

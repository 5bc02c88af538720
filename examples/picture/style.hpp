#pragma once

#include "canvas.hpp"
#include "colour.hpp"

/// What makes a strip look as it does: one place to tune it. Lengths are pixels.
namespace pliant::picture::style {

inline constexpr Colour ink{0.13, 0.13, 0.15};
inline constexpr Colour grey{0.62, 0.62, 0.64};

inline constexpr Font title_font{32, Weight::Bold};
inline constexpr Font footer_font{22};
inline constexpr double largest_caption = 24;
inline constexpr double smallest_caption = 20;  // below this, captions wrap instead

inline constexpr double picture_width = 1800;   // where the caller leaves the frame width open
inline constexpr int film_width = 720;          // of a frame, where the caller leaves it open
inline constexpr double tallest_frame = 1000;   // where the caller leaves the frame height open
inline constexpr double narrowest_frame = 260;  // room for a caption
inline constexpr double narrowest_picture = 720;
inline constexpr double largest_picture = 30000;  // what an image of Cairo holds, a little less
inline constexpr double page_shape = 1.7;         // width over height, where columns are left open

inline constexpr double margin = 40;
inline constexpr double gutter = 36;
inline constexpr double title_gap = 24;
inline constexpr double caption_gap = 14;
inline constexpr double footer_gap = 56;  // between its items
inline constexpr double footer_row_gap = 10;

inline constexpr double edge_part = 0.075;     // width of an element's edges over its thickness
inline constexpr double fading_element = 3.5;  // thinner elements have still fainter edges
inline constexpr double thinnest_edge = 0.03;  // what would be thinner is left out
inline constexpr double thickest_edge = 1.2;
inline constexpr double least_light = 0.65;  // of a facet of a solid that is seen edge on
inline constexpr double outline_width = 1.3;
inline constexpr double clamp_width = 2.6;
inline constexpr double hatch_width = 1.2;
inline constexpr double hatch_depth = 12;
inline constexpr double hatch_spacing = 9;

inline constexpr double bar_width = 280;
inline constexpr double bar_height = 20;
inline constexpr double longest_scale = 200;  // of the bar that shows a length

}  // namespace pliant::picture::style

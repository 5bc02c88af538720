#pragma once

#include "canvas.hpp"
#include "frame.hpp"

namespace pliant::picture {

/// Where a frame lies on the sheet, and how its lengths map onto pixels.
struct View {
  double scale;  // pixels per length
  Point centre;  // of what it shows, in lengths
  Point pixel;   // where that centre lies

  Point operator()(Point p) const {
    return {pixel[0] + scale * (p[0] - centre[0]), pixel[1] - scale * (p[1] - centre[1])};
  }
};

/// Draws all of a frame but its caption. Internal to the picture library.
void draw_frame(Canvas& canvas, Frame const& frame, View const& view);

}  // namespace pliant::picture

#include "strip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "canvas.hpp"
#include "draw_frame.hpp"
#include "footer.hpp"
#include "style.hpp"

namespace pliant::picture {

using namespace style;

namespace {

template <class... Parts>
[[noreturn]] void fail(Parts const&... parts) {
  std::ostringstream message;
  message << "cannot draw a strip of frames: ";
  (message << ... << parts);
  throw std::runtime_error(message.str());
}

struct Box {
  Point lowest{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  Point highest{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};

  double width() const { return highest[0] - lowest[0]; }
  double height() const { return highest[1] - lowest[1]; }
  Point centre() const { return {lowest[0] + width() / 2, lowest[1] + height() / 2}; }

  void include(Point p) {
    for (std::size_t d : {0u, 1u}) {
      lowest[d] = std::min(lowest[d], p[d]);
      highest[d] = std::max(highest[d], p[d]);
    }
  }
};

Box bound(std::span<Frame const> frames) {
  Box box;
  for (auto const& frame : frames) {
    for (auto const& polygon : frame.polygons) {
      for (auto const& p : polygon.corners) box.include(p);
    }
    for (auto const* segments : {&frame.clamps, &frame.outline}) {
      for (auto const& [from, to] : *segments) {
        box.include(from);
        box.include(to);
      }
    }
  }
  return box;
}

template <class Points>
void check_points(Points const& points, std::size_t frame, char const* what, std::size_t index) {
  for (auto const& [x, y] : points) {
    if (!std::isfinite(x) || !std::isfinite(y)) {
      fail("frame ", frame, ", ", what, " ", index, " (counted from 0) has the point (", x, ", ", y,
           "); check the displacements it was made from");
    }
  }
}

void check_polygon(Polygon const& polygon, std::size_t frame, std::size_t index) {
  check_points(polygon.corners, frame, "polygon", index);
  if (polygon.corners.size() < 3) {
    fail("frame ", frame, ", polygon ", index, " (counted from 0) has ", polygon.corners.size(),
         " corners; give it at least 3");
  }
  if (!std::isfinite(polygon.fill.r + polygon.fill.g + polygon.fill.b)) {
    fail("frame ", frame, ", polygon ", index,
         " (counted from 0) has a colour that is not finite; check the value it stands for");
  }
}

void check(std::span<Frame const> frames, Options const& options) {
  if (options.columns < 0 || options.frame_width < 0 || options.frame_height < 0) {
    fail("columns ", options.columns, ", frame_width ", options.frame_width, " and frame_height ",
         options.frame_height, " must not be negative; 0 leaves them to be chosen");
  }
  if (std::all_of(frames.begin(), frames.end(), [](auto const& f) { return f.polygons.empty(); })) {
    fail("there is no polygon in any of the ", frames.size(),
         " frames; give at least one frame with at least one polygon");
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    auto const& [polygons, caption, clamps, outline] = frames[f];
    for (std::size_t i = 0; i < polygons.size(); ++i) check_polygon(polygons[i], f, i);
    for (std::size_t i = 0; i < clamps.size(); ++i) check_points(clamps[i], f, "clamp", i);
    for (std::size_t i = 0; i < outline.size(); ++i) check_points(outline[i], f, "outline", i);
  }
  Box const box = bound(frames);
  double const size = std::max(box.width(), box.height());
  if (!std::isfinite(size) || size <= 0) {
    fail("all frames together measure ", box.width(), " x ", box.height(),
         "; give polygons of a finite size");
  }
}

// How the frames lie on the sheet. All have one scale and one width; a row is as high as it needs.
struct Grid {
  std::size_t columns;
  double frame_width;
  double scale;   // pixels per length
  double centre;  // of all frames, along x
  struct Row {
    Box box;  // what its frames show
    double height;
  };
  std::vector<Row> rows;

  double width() const { return static_cast<double>(columns) * (frame_width + gutter) - gutter; }
};

// So many that the picture is about as wide as a page.
std::size_t choose_columns(std::size_t count, double shape) {
  auto const misfit = [&](std::size_t columns) {
    auto const rows = static_cast<double>((count + columns - 1) / columns);
    return std::abs(std::log(static_cast<double>(columns) / rows * shape / page_shape));
  };
  std::size_t best = 1;
  for (std::size_t columns = 2; columns <= count; ++columns) {
    if (misfit(columns) < misfit(best)) best = columns;
  }
  return best;
}

Grid arrange(std::span<Frame const> frames, Options const& options) {
  bool const is_clamped =
      std::any_of(frames.begin(), frames.end(), [](auto const& f) { return !f.clamps.empty(); });
  double const pad = is_clamped ? hatch_depth + hatch_spacing : 2;
  Box const all = bound(frames);
  // A box without height (or width) takes any scale in that direction.
  double const wide = std::max(all.width(), 1e-6 * all.height());
  double const high = std::max(all.height(), 1e-6 * all.width());

  Grid grid{};
  grid.centre = all.centre()[0];
  grid.columns = options.columns > 0
                     ? std::min(static_cast<std::size_t>(options.columns), frames.size())
                     : choose_columns(frames.size(), wide / high);
  double highest = 0;
  for (std::size_t first = 0; first < frames.size(); first += grid.columns) {
    auto const row = frames.subspan(first, std::min(grid.columns, frames.size() - first));
    bool const is_empty =
        std::all_of(row.begin(), row.end(), [](auto const& f) { return f.polygons.empty(); });
    grid.rows.push_back({options.frame_height > 0 || is_empty ? all : bound(row), 0});
    highest = std::max({highest, grid.rows.back().box.height(), 1e-6 * wide});
  }

  auto const columns = static_cast<double>(grid.columns);
  double const share = std::floor((picture_width - 2 * margin - (columns - 1) * gutter) / columns);
  grid.frame_width = options.frame_width > 0 ? options.frame_width : std::max(share, 4 * pad);
  double const height = options.frame_height > 0 ? options.frame_height : tallest_frame;
  grid.scale = std::min((grid.frame_width - 2 * pad) / wide, (height - 2 * pad) / highest);
  if (grid.scale <= 0) {
    fail("frames of ", grid.frame_width, " x ", height,
         " pixels leave no room inside their border of ", pad,
         "; make frame_width and frame_height larger");
  }
  if (options.frame_width == 0) {
    double const needed = std::round(grid.scale * wide + 2 * pad);
    grid.frame_width = std::max(needed, std::min(grid.frame_width, narrowest_frame));
  }
  for (auto& row : grid.rows) {
    row.height = options.frame_height > 0 ? options.frame_height
                                          : std::ceil(grid.scale * row.box.height() + 2 * pad);
  }
  return grid;
}

// Lines of text, centred one below the other.
struct Block {
  Font font;
  std::vector<std::string> lines;

  double height() const { return static_cast<double>(lines.size()) * font.line_height(); }

  void draw(Canvas& canvas, Point top) const {
    for (auto const& line : lines) {
      canvas.text(line, font, {top[0], top[1] + font.line_height() / 2}, Align::Centre, ink);
      top[1] += font.line_height();
    }
  }
};

// One size for all: the largest at which no caption wraps; where none is, the largest.
std::vector<Block> set_captions(Canvas& sheet, std::span<Frame const> frames, double width) {
  auto const set = [&](double size, double wrap_at) {
    std::vector<Block> captions;
    for (auto const& frame : frames) {
      captions.push_back({Font{size}, sheet.wrap(frame.caption, Font{size}, wrap_at)});
    }
    return captions;
  };
  for (double size = largest_caption; size >= smallest_caption; --size) {
    auto captions = set(size, std::numeric_limits<double>::max());
    bool const fits = std::all_of(captions.begin(), captions.end(), [&](Block const& caption) {
      return std::all_of(caption.lines.begin(), caption.lines.end(), [&](auto const& line) {
        return sheet.text_width(line, caption.font) <= width;
      });
    });
    if (fits) return captions;
  }
  return set(largest_caption, width);
}

}  // namespace

void write_strip(std::filesystem::path const& path, std::span<Frame const> frames,
                 Options const& options) {
  check(frames, options);
  Grid const grid = arrange(frames, options);
  double const width = std::max(grid.width(), narrowest_picture);

  Canvas sheet{1, 1};  // to measure text on
  Block const title{title_font, sheet.wrap(options.title, title_font, width)};
  auto const captions = set_captions(sheet, frames, grid.frame_width);
  Footer const footer{sheet, options, grid.scale, width};

  double caption_height = 0;
  for (auto const& caption : captions) caption_height = std::max(caption_height, caption.height());
  if (caption_height > 0) caption_height += caption_gap;

  double const top = margin + title.height() + (title.lines.empty() ? 0 : title_gap);
  double bottom = top - gutter;
  for (auto const& row : grid.rows) bottom += row.height + caption_height + gutter;
  double const sheet_width = std::ceil(width + 2 * margin);
  double const sheet_height =
      std::ceil(bottom + (footer.height() > 0 ? gutter + footer.height() : 0) + margin);
  if (std::max(sheet_width, sheet_height) > largest_picture) {
    fail("it would take ", sheet_width, " x ", sheet_height, " pixels, and no side may exceed ",
         largest_picture, "; draw fewer or smaller frames");
  }

  Canvas canvas{static_cast<int>(sheet_width), static_cast<int>(sheet_height)};
  double const middle = margin + width / 2;
  title.draw(canvas, {middle, margin});
  double y = top;
  for (std::size_t r = 0; r < grid.rows.size(); ++r) {
    auto const& row = grid.rows[r];
    double x = middle - grid.width() / 2 + grid.frame_width / 2;
    auto const end = std::min((r + 1) * grid.columns, frames.size());
    for (std::size_t f = r * grid.columns; f < end; ++f) {
      Point const centre{grid.centre, row.box.centre()[1]};
      draw_frame(canvas, frames[f], {grid.scale, centre, {x, y + row.height / 2}});
      captions[f].draw(canvas, {x, y + row.height + caption_gap});
      x += grid.frame_width + gutter;
    }
    y += row.height + caption_height + gutter;
  }
  footer.draw(canvas, {middle, y});
  canvas.write_png(path);
}

}  // namespace pliant::picture

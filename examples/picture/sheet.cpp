#include "sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <stdexcept>

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

}  // namespace

struct Sheet::Box {
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

Sheet::Box Sheet::bound(std::span<Frame const> frames) {
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

void Sheet::check(std::span<Frame const> frames, Options const& options) {
  if (options.columns < 0 || options.frame_width < 0 || options.frame_height < 0) {
    fail("columns ", options.columns, ", frame_width ", options.frame_width, " and frame_height ",
         options.frame_height, " must not be negative; 0 leaves them to be chosen");
  }
  if (std::all_of(frames.begin(), frames.end(), [](auto const& f) { return f.polygons.empty(); })) {
    fail("there is no polygon in any of the ", frames.size(),
         " frames; give at least one frame with at least one polygon");
  }
  for (std::size_t f = 0; f < frames.size(); ++f) {
    auto const& [polygons, caption, clamps, outline, layers] = frames[f];
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

Sheet::Sheet(std::span<Frame const> frames, Options const& options, Sheets sheets)
    : frames_(frames), options_(options) {
  check(frames, options);
  arrange(sheets);
  Canvas canvas{1, 1};  // to measure text on
  captions_ = set_captions(canvas, frames, frame_width_);
  for (auto const& caption : captions_)
    caption_height_ = std::max(caption_height_, caption.height());
  if (caption_height_ > 0) caption_height_ += caption_gap;
}

void Sheet::arrange(Sheets sheets) {
  bool const is_clamped =
      std::any_of(frames_.begin(), frames_.end(), [](auto const& f) { return !f.clamps.empty(); });
  double const pad = is_clamped ? hatch_depth + hatch_spacing : 2;
  Box const all = bound(frames_);
  // A box without height (or width) takes any scale in that direction.
  double const wide = std::max(all.width(), 1e-6 * all.height());
  double const high = std::max(all.height(), 1e-6 * all.width());

  columns_ = options_.columns > 0
                 ? std::min(static_cast<std::size_t>(options_.columns), frames_.size())
                 : choose_columns(frames_.size(), wide / high);
  std::vector<Box> shown;  // by each row
  double highest = 0;
  for (std::size_t first = 0; first < frames_.size(); first += columns_) {
    auto const row = frames_.subspan(first, std::min(columns_, frames_.size() - first));
    bool const is_empty =
        std::all_of(row.begin(), row.end(), [](auto const& f) { return f.polygons.empty(); });
    bool const takes_all = sheets == Sheets::many || options_.frame_height > 0 || is_empty;
    shown.push_back(takes_all ? all : bound(row));
    highest = std::max({highest, shown.back().height(), 1e-6 * wide});
  }

  auto const columns = static_cast<double>(columns_);
  double const share = std::floor((picture_width - 2 * margin - (columns - 1) * gutter) / columns);
  frame_width_ = options_.frame_width > 0 ? options_.frame_width : std::max(share, 4 * pad);
  double const height = options_.frame_height > 0 ? options_.frame_height : tallest_frame;
  scale_ = std::min((frame_width_ - 2 * pad) / wide, (height - 2 * pad) / highest);
  if (scale_ <= 0) {
    fail("frames of ", frame_width_, " x ", height, " pixels leave no room inside their border of ",
         pad, "; make frame_width and frame_height larger");
  }
  if (options_.frame_width == 0) {
    double const needed = std::round(scale_ * wide + 2 * pad);
    frame_width_ = std::max(needed, std::min(frame_width_, narrowest_frame));
  }
  for (auto const& box : shown) {
    rows_.push_back({{all.centre()[0], box.centre()[1]},
                     options_.frame_height > 0 ? options_.frame_height
                                               : std::ceil(scale_ * box.height() + 2 * pad)});
  }
}

double Sheet::row_width() const {
  return static_cast<double>(columns_) * (frame_width_ + gutter) - gutter;
}

void Sheet::Block::draw(Canvas& canvas, Point top) const {
  for (auto const& line : lines) {
    canvas.text(line, font, {top[0], top[1] + font.line_height() / 2}, Align::Centre, ink);
    top[1] += font.line_height();
  }
}

// One size for all: the largest at which no caption wraps; where none is, the largest.
std::vector<Sheet::Block> Sheet::set_captions(Canvas& canvas, std::span<Frame const> frames,
                                              double width) {
  auto const set = [&](double size, double wrap_at) {
    std::vector<Block> captions;
    for (auto const& frame : frames) {
      captions.push_back({Font{size}, canvas.wrap(frame.caption, Font{size}, wrap_at)});
    }
    return captions;
  };
  for (double size = largest_caption; size >= smallest_caption; --size) {
    auto captions = set(size, std::numeric_limits<double>::max());
    bool const fits = std::all_of(captions.begin(), captions.end(), [&](Block const& caption) {
      return std::all_of(caption.lines.begin(), caption.lines.end(), [&](auto const& line) {
        return canvas.text_width(line, caption.font) <= width;
      });
    });
    if (fits) return captions;
  }
  return set(largest_caption, width);
}

void Sheet::write(std::filesystem::path const& path, std::size_t first, std::size_t count) const {
  double const width = std::max(row_width(), narrowest_picture);
  Canvas measure{1, 1};  // to measure text on
  Block const title{title_font, measure.wrap(options_.title, title_font, width)};
  Footer const footer{measure, options_, scale_, width};
  auto const first_row = first / columns_, end_row = (first + count + columns_ - 1) / columns_;

  double const top = margin + title.height() + (title.lines.empty() ? 0 : title_gap);
  double bottom = top - gutter;
  for (auto r = first_row; r < end_row; ++r) bottom += rows_[r].height + caption_height_ + gutter;
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
  for (auto r = first_row; r < end_row; ++r) {
    double x = middle - row_width() / 2 + frame_width_ / 2;
    auto const end = std::min((r + 1) * columns_, first + count);
    for (std::size_t f = r * columns_; f < end; ++f) {
      draw_frame(canvas, frames_[f], {scale_, rows_[r].centre, {x, y + rows_[r].height / 2}});
      captions_[f].draw(canvas, {x, y + rows_[r].height + caption_gap});
      x += frame_width_ + gutter;
    }
    y += rows_[r].height + caption_height_ + gutter;
  }
  footer.draw(canvas, {middle, y});
  canvas.write_png(path);
}

}  // namespace pliant::picture

#include "footer.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "style.hpp"

namespace pliant::picture {

using namespace style;

namespace {

std::string write_number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// The round length (1, 2 or 5 times a power of ten) that is at most `length`.
double round_down(double length) {
  double const power = std::pow(10, std::floor(std::log10(length)));
  for (double const digit : {5.0, 2.0}) {
    if (digit * power <= length) return digit * power;
  }
  return power;
}

// Thin lines are sharp where they run through the middle of pixels.
Point to_pixel_centre(Point p) { return {std::floor(p[0]) + 0.5, std::floor(p[1]) + 0.5}; }

}  // namespace

Footer::Footer(Canvas& sheet, Options const& options, double scale, double width) {
  Row items;
  if (!options.colour_bar.label.empty()) {
    items.push_back(make_colour_bar(sheet, options.colour_bar));
  }
  for (auto const& entry : options.legend) items.push_back(make_legend_entry(sheet, entry));
  if (!options.length_unit.empty()) {
    items.push_back(make_length_bar(sheet, options.length_unit, scale));
  }
  for (auto& item : items) {
    if (rows_.empty() || measure_width(rows_.back()) + footer_gap + item.width > width) {
      rows_.emplace_back();
    }
    rows_.back().push_back(std::move(item));
  }
}

double Footer::height() const {
  double height = 0;
  for (auto const& row : rows_) height += measure_height(row) + footer_row_gap;
  return std::max(height - footer_row_gap, 0.0);
}

void Footer::draw(Canvas& canvas, Point top_centre) const {
  double top = top_centre[1];
  for (auto const& row : rows_) {
    Point at{top_centre[0] - measure_width(row) / 2, top + footer_font.line_height() / 2};
    for (auto const& item : row) {
      item.draw(canvas, at);
      at[0] += item.width + footer_gap;
    }
    top += measure_height(row) + footer_row_gap;
  }
}

double Footer::measure_width(Row const& row) {
  double width = -footer_gap;
  for (auto const& item : row) width += item.width + footer_gap;
  return width;
}

double Footer::measure_height(Row const& row) {
  double below = 0;
  for (auto const& item : row) below = std::max(below, item.below);
  return footer_font.line_height() / 2 + below;
}

Footer::Item Footer::make_colour_bar(Canvas& sheet, ColourBar const& bar) {
  double constexpr tick = 5;
  double constexpr gap = 8;
  double const label = sheet.text_width(bar.label, footer_font) + 20;
  auto const draw = [=](Canvas& canvas, Point at) {
    canvas.text(bar.label, footer_font, at, Align::Left, ink);
    Point const corner = to_pixel_centre({at[0] + label, at[1] - bar_height / 2});
    for (double x = 0; x < bar_width; ++x) {
      canvas.rectangle({corner[0] - 0.5 + x, corner[1] - 0.5}, 1, bar_height,
                       green_to_red((x + 0.5) / bar_width));
    }
    canvas.frame_rectangle(corner, bar_width - 1, bar_height - 1, ink);
    for (double const part : {0.0, 0.5, 1.0}) {
      double const x = corner[0] + std::round(part * (bar_width - 1));
      double const y = corner[1] + bar_height;
      canvas.line({x, y}, {x, y + tick}, ink, 1);
      canvas.text(write_number(std::lerp(bar.lowest, bar.highest, part)), footer_font,
                  {x, y + gap + footer_font.line_height() / 2}, Align::Centre, ink);
    }
  };
  // The last number reaches beyond the bar by half its width.
  double const overhang = sheet.text_width(write_number(bar.highest), footer_font) / 2;
  return {label + bar_width + overhang, bar_height / 2 + gap + footer_font.line_height(), draw};
}

Footer::Item Footer::make_legend_entry(Canvas& sheet, LegendEntry const& entry) {
  double constexpr label = bar_height + 12;
  auto const draw = [entry](Canvas& canvas, Point at) {
    Point const corner = to_pixel_centre({at[0], at[1] - bar_height / 2});
    canvas.rectangle(corner, bar_height - 1, bar_height - 1, entry.colour);
    canvas.frame_rectangle(corner, bar_height - 1, bar_height - 1, ink);
    canvas.text(entry.label, footer_font, {at[0] + label, at[1]}, Align::Left, ink);
  };
  return {label + sheet.text_width(entry.label, footer_font), footer_font.line_height() / 2, draw};
}

Footer::Item Footer::make_length_bar(Canvas& sheet, std::string const& unit, double scale) {
  double constexpr half_cap = 6;
  double constexpr gap = 14;
  double const length = round_down(longest_scale / scale);
  double const end = length * scale;
  auto const label = write_number(length) + " " + unit;
  auto const draw = [=](Canvas& canvas, Point at) {
    canvas.line(at, {at[0] + end, at[1]}, ink, 2);
    for (double const x : {at[0], at[0] + end}) {
      canvas.line({x, at[1] - half_cap}, {x, at[1] + half_cap}, ink, 2);
    }
    canvas.text(label, footer_font, {at[0] + end + gap, at[1]}, Align::Left, ink);
  };
  return {end + gap + sheet.text_width(label, footer_font), footer_font.line_height() / 2, draw};
}

}  // namespace pliant::picture

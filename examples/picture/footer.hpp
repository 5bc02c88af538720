#pragma once

#include <functional>
#include <vector>

#include "canvas.hpp"
#include "strip.hpp"

namespace pliant::picture {

/// What lies below the frames: colour bar, legend and scale, in as many centred rows as they need.
/// Internal to the picture library.
class Footer {
 public:
  /// Measures text on `sheet`; `scale` is in pixels per length, `width` what a row may take.
  Footer(Canvas& sheet, Options const& options, double scale, double width);

  double height() const;
  void draw(Canvas& canvas, Point top_centre) const;

 private:
  // Drawn from its left end, centred on a height.
  struct Item {
    double width;
    double below;  // the height it needs below its centre
    std::function<void(Canvas&, Point)> draw;
  };
  using Row = std::vector<Item>;

  static Item make_colour_bar(Canvas& sheet, ColourBar const& bar);
  static Item make_legend_entry(Canvas& sheet, LegendEntry const& entry);
  static Item make_length_bar(Canvas& sheet, std::string const& unit, double scale);
  static double measure_width(Row const& row);
  static double measure_height(Row const& row);

  std::vector<Row> rows_;
};

}  // namespace pliant::picture

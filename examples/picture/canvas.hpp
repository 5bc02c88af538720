#pragma once

#include <cairo.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "colour.hpp"
#include "frame.hpp"

namespace pliant::picture {

enum class Weight { Normal, Bold };
enum class Align { Left, Centre };

struct Font {
  double size;  // pixels
  Weight weight = Weight::Normal;
  double line_height() const { return 1.3 * size; }
};

/// A white sheet of pixels, y pointing down, and the few verbs that a strip is drawn with.
/// Internal to the picture library: `write_strip` is the way in.
class Canvas {
 public:
  Canvas(int width, int height);

  void fill(std::vector<Point> const& corners, Colour colour);
  void stroke(std::vector<Point> const& corners, Colour colour, double width);
  void line(Point from, Point to, Colour colour, double width);
  void rectangle(Point corner, double width, double height, Colour fill);
  void frame_rectangle(Point corner, double width, double height, Colour colour);

  double text_width(std::string_view text, Font font);
  /// Breaks at newlines, and between words so that no line is wider than `width`, unless one word
  /// is.
  std::vector<std::string> wrap(std::string_view text, Font font, double width);
  /// One line of text, its capitals centred on height `at[1]`.
  void text(std::string_view text, Font font, Point at, Align align, Colour colour);

  void write_png(std::filesystem::path const& path);

 private:
  struct Run;

  void use(Colour colour);
  void use(Font font, bool is_symbol);
  void trace(std::vector<Point> const& corners);
  double advance(Run const& run, Font font);
  static std::vector<Run> split_symbols(std::string_view text);

  struct Release {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  std::unique_ptr<cairo_surface_t, Release> surface_;
  std::unique_ptr<cairo_t, Release> context_;
};

}  // namespace pliant::picture

#include "canvas.hpp"

#include <cctype>
#include <cstddef>
#include <sstream>
#include <stdexcept>

namespace pliant::picture {

namespace {

// Bytes above ASCII belong to letters such as those of Greek.
bool is_word(char c) {
  auto const byte = static_cast<unsigned char>(c);
  return byte >= 0x80 || std::isalnum(byte) != 0;
}

// How many bytes of UTF-8 belong to the character that begins at `i`.
std::size_t character_length(std::string_view text, std::size_t i) {
  std::size_t end = i + 1;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) ++end;
  return end - i;
}

}  // namespace

// A stretch of text in one style.
struct Canvas::Run {
  std::string text;
  enum class Style { Plain, Symbol, Subscript } style;
};

Canvas::Canvas(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      context_(cairo_create(surface_.get())) {
  if (cairo_status(context_.get()) != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error("cannot make a picture of " + std::to_string(width) + " x " +
                             std::to_string(height) +
                             " pixels: " + cairo_status_to_string(cairo_status(context_.get())) +
                             "; draw fewer or smaller frames");
  }
  cairo_set_source_rgb(context_.get(), 1, 1, 1);
  cairo_paint(context_.get());
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);

  // Hinting moves letters to whole pixels, which spoils their spacing.
  std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> const smooth{
      cairo_font_options_create(), &cairo_font_options_destroy};
  cairo_font_options_set_antialias(smooth.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(smooth.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(smooth.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context_.get(), smooth.get());
}

void Canvas::use(Colour colour) {
  cairo_set_source_rgb(context_.get(), colour.r, colour.g, colour.b);
}

void Canvas::use(Font font, bool is_symbol) {
  cairo_select_font_face(
      context_.get(), "sans-serif", is_symbol ? CAIRO_FONT_SLANT_ITALIC : CAIRO_FONT_SLANT_NORMAL,
      font.weight == Weight::Bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), font.size);
}

void Canvas::trace(std::vector<Point> const& corners) {
  cairo_new_path(context_.get());
  for (auto const& [x, y] : corners) cairo_line_to(context_.get(), x, y);
  cairo_close_path(context_.get());
}

void Canvas::fill(std::vector<Point> const& corners, Colour colour) {
  trace(corners);
  use(colour);
  cairo_fill(context_.get());
}

void Canvas::stroke(std::vector<Point> const& corners, Colour colour, double width) {
  trace(corners);
  use(colour);
  cairo_set_line_width(context_.get(), width);
  cairo_stroke(context_.get());
}

void Canvas::line(Point from, Point to, Colour colour, double width) {
  cairo_new_path(context_.get());
  cairo_move_to(context_.get(), from[0], from[1]);
  cairo_line_to(context_.get(), to[0], to[1]);
  use(colour);
  cairo_set_line_width(context_.get(), width);
  cairo_stroke(context_.get());
}

void Canvas::rectangle(Point corner, double width, double height, Colour fill) {
  cairo_rectangle(context_.get(), corner[0], corner[1], width, height);
  use(fill);
  cairo_fill(context_.get());
}

void Canvas::frame_rectangle(Point corner, double width, double height, Colour colour) {
  cairo_rectangle(context_.get(), corner[0], corner[1], width, height);
  use(colour);
  cairo_set_line_width(context_.get(), 1);
  cairo_stroke(context_.get());
}

// "max(R_L, 1)" is "max(", symbol "R", subscript "L", ", 1)"; "max_level" stays as it is.
std::vector<Canvas::Run> Canvas::split_symbols(std::string_view text) {
  std::vector<Run> runs{{"", Run::Style::Plain}};
  for (std::size_t i = 0; i < text.size();) {
    bool const starts_word = i == 0 || (!is_word(text[i - 1]) && text[i - 1] != '_');
    std::size_t const bar = i + character_length(text, i);
    if (starts_word && is_word(text[i]) && bar + 1 < text.size() && text[bar] == '_' &&
        is_word(text[bar + 1])) {
      std::size_t end = bar + 1;
      while (end < text.size() && is_word(text[end])) ++end;
      runs.push_back({std::string{text.substr(i, bar - i)}, Run::Style::Symbol});
      runs.push_back({std::string{text.substr(bar + 1, end - bar - 1)}, Run::Style::Subscript});
      runs.push_back({"", Run::Style::Plain});
      i = end;
    } else {
      runs.back().text += text[i++];
    }
  }
  return runs;
}

double Canvas::advance(Run const& run, Font font) {
  use(run.style == Run::Style::Subscript ? Font{0.7 * font.size, font.weight} : font,
      run.style == Run::Style::Symbol);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), run.text.c_str(), &extents);
  return extents.x_advance;
}

double Canvas::text_width(std::string_view text, Font font) {
  double width = 0;
  for (auto const& run : split_symbols(text)) width += advance(run, font);
  return width;
}

std::vector<std::string> Canvas::wrap(std::string_view text, Font font, double width) {
  std::vector<std::string> lines;
  std::istringstream paragraphs{std::string{text}};
  for (std::string paragraph; std::getline(paragraphs, paragraph);) {
    lines.emplace_back();
    std::istringstream words{paragraph};
    for (std::string word; words >> word;) {
      auto const longer = lines.back().empty() ? word : lines.back() + ' ' + word;
      if (lines.back().empty() || text_width(longer, font) <= width) {
        lines.back() = longer;
      } else {
        lines.push_back(word);
      }
    }
  }
  return lines;
}

void Canvas::text(std::string_view text, Font font, Point at, Align align, Colour colour) {
  double constexpr half_capital = 0.36;  // of the size, for the usual sans faces
  double x = align == Align::Centre ? at[0] - text_width(text, font) / 2 : at[0];
  double const baseline = at[1] + half_capital * font.size;
  use(colour);
  for (auto const& run : split_symbols(text)) {
    double const drop = run.style == Run::Style::Subscript ? 0.2 * font.size : 0;
    double const width = advance(run, font);
    cairo_move_to(context_.get(), x, baseline + drop);
    cairo_show_text(context_.get(), run.text.c_str());
    x += width;
  }
}

void Canvas::write_png(std::filesystem::path const& path) {
  for (auto const status : {cairo_status(context_.get()),
                            cairo_surface_write_to_png(surface_.get(), path.string().c_str())}) {
    if (status != CAIRO_STATUS_SUCCESS) {
      throw std::runtime_error("cannot write the picture '" + path.string() +
                               "': " + cairo_status_to_string(status) +
                               "; name a file in a folder that exists and can be written to");
    }
  }
}

}  // namespace pliant::picture

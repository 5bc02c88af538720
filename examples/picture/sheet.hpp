#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "canvas.hpp"
#include "strip.hpp"

namespace pliant::picture {

/// One: all frames on one sheet. Many: a sheet for each, all of one size and scale.
enum class Sheets { one, many };

/// Draws frames row by row, with what stands above and below them. Internal to the picture library.
class Sheet {
 public:
  /// Throws what `write_strip` does, but for files.
  Sheet(std::span<Frame const> frames, Options const& options, Sheets sheets);

  /// Draws `count` of the frames, from the first named, into a PNG file.
  void write(std::filesystem::path const& path, std::size_t first, std::size_t count) const;

 private:
  struct Box;
  // All frames have one scale and one width; a row is as high as it needs.
  struct Row {
    Point centre;  // of what its frames show
    double height;
  };
  // Lines of text, centred one below the other.
  struct Block {
    Font font;
    std::vector<std::string> lines;

    double height() const { return static_cast<double>(lines.size()) * font.line_height(); }
    void draw(Canvas& canvas, Point top) const;
  };

  static Box bound(std::span<Frame const> frames);
  static void check(std::span<Frame const> frames, Options const& options);
  static std::vector<Block> set_captions(Canvas& canvas, std::span<Frame const> frames,
                                         double width);
  void arrange(Sheets sheets);
  double row_width() const;

  std::span<Frame const> frames_;
  Options options_;
  std::size_t columns_ = 1;
  double frame_width_ = 0;
  double scale_ = 0;  // pixels per length
  std::vector<Row> rows_;
  std::vector<Block> captions_;
  double caption_height_ = 0;
};

}  // namespace pliant::picture

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace odoless {

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  bool operator==(const Rgb&) const = default;
};

/// A place on a canvas; row 0 is the top.
struct Pixel {
  int column_px = 0;
  int row_px = 0;
};

/// A picture of pixels; what lies outside is not set. Lines and text are drawing.hpp's.
class Canvas {
 public:
  Canvas(int width_px, int height_px, Rgb background);

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  [[nodiscard]] Rgb at(Pixel pixel) const { return pixels_[index(pixel)]; }
  [[nodiscard]] bool contains(Pixel pixel) const;

  void set(Pixel pixel, Rgb colour);
  /// Red, green and blue of each pixel, row by row from the top.
  [[nodiscard]] std::uint8_t* bytes() { return &pixels_.front().red; }

  /// The picture as a PNG file.
  [[nodiscard]] std::string png() const;

 private:
  [[nodiscard]] std::size_t index(Pixel pixel) const;

  int width_px_;
  int height_px_;
  std::vector<Rgb> pixels_;
};

}  // namespace odoless

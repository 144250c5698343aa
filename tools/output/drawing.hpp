#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/output/canvas.hpp"

namespace odoless {

/// A spot on a drawing, from its top left corner.
struct Spot {
  double x_px = 0.0;
  double y_px = 0.0;
};

struct Stroke {
  Rgb colour{};
  double width_px = 2.0;
  double opacity = 1.0;
};

enum class Align { kLeft, kMiddle, kRight };

struct TextStyle {
  double height_px = 14.0;
  Align align = Align::kLeft;
  Rgb colour{};
};

/// Pictures, lines, shapes and text, one over the other as they come: as SVG, or as pixels (by Anti-Grain Geometry,
/// whose strokes make the letters, so that no font is needed). All places are finite.
class Drawing {
 public:
  Drawing(int width_px, int height_px, Rgb background);

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }

  void image(Pixel top_left, Canvas picture);
  void line(std::span<const Spot> places, const Stroke& stroke);
  void rectangle(Spot top_left, Spot bottom_right, Rgb colour);
  void disc(Spot centre, double radius_px, Rgb colour);
  /// Printable ASCII; anything else is left out. @param place  Where the line of text stands.
  void text(Spot place, std::string_view words, const TextStyle& style = {});

  [[nodiscard]] Canvas pixels() const;
  [[nodiscard]] std::string svg() const;

 private:
  struct Image {
    Pixel top_left;
    Canvas picture;
  };
  struct Line {
    std::vector<Spot> places;
    Stroke stroke;
  };
  struct Rectangle {
    Spot top_left;
    Spot bottom_right;
    Rgb colour;
  };
  struct Disc {
    Spot centre;
    double radius_px;
    Rgb colour;
  };
  struct Text {
    Spot place;
    std::string words;
    TextStyle style;
  };
  class Painter;
  class SvgWriter;

  int width_px_;
  int height_px_;
  Rgb background_;
  std::vector<std::variant<Image, Line, Rectangle, Disc, Text>> marks_;
};

}  // namespace odoless

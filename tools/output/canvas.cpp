#include "tools/output/canvas.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr int kGlyphColumns = 5;
constexpr int kGlyphRows = 7;
constexpr int kGlyphScalePx = 2;

struct Glyph {
  char character;
  std::array<std::uint8_t, kGlyphRows> rows;  ///< 5 bits each, the left column highest
};

constexpr std::array<Glyph, 11> kGlyphs{{
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}},
    {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f}},
    {'3', {0x0e, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}},
    {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x0e, 0x10, 0x10, 0x1e, 0x11, 0x11, 0x0e}},
    {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}},
    {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x01, 0x0e}},
    {'m', {0x00, 0x00, 0x1a, 0x15, 0x15, 0x15, 0x15}},
}};

void draw_glyph(Canvas& canvas, Pixel at, const Glyph& glyph, Rgb colour) {
  for (int bit = 0; bit < kGlyphRows * kGlyphColumns; ++bit) {
    const int row = bit / kGlyphColumns;
    const int column = bit % kGlyphColumns;
    const unsigned mask = 1U << static_cast<unsigned>(kGlyphColumns - 1 - column);
    if ((glyph.rows[static_cast<std::size_t>(row)] & mask) != 0) {
      const Pixel corner{at.column_px + column * kGlyphScalePx, at.row_px + row * kGlyphScalePx};
      canvas.rectangle(corner, {corner.column_px + kGlyphScalePx - 1, corner.row_px + kGlyphScalePx - 1}, colour);
    }
  }
}

}  // namespace

Canvas::Canvas(int width_px, int height_px, Rgb background)
    : width_px_(width_px),
      height_px_(height_px),
      pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), background) {
  ODOLESS_CHECK(width_px > 0 && height_px > 0);
}

std::size_t Canvas::index(Pixel pixel) const {
  return static_cast<std::size_t>(pixel.row_px) * static_cast<std::size_t>(width_px_) +
         static_cast<std::size_t>(pixel.column_px);
}

bool Canvas::contains(Pixel pixel) const {
  return pixel.column_px >= 0 && pixel.column_px < width_px_ && pixel.row_px >= 0 && pixel.row_px < height_px_;
}

void Canvas::set(Pixel pixel, Rgb colour) {
  if (contains(pixel)) {
    pixels_[index(pixel)] = colour;
  }
}

void Canvas::rectangle(Pixel top_left, Pixel bottom_right, Rgb colour) {
  for (int row = std::max(top_left.row_px, 0); row <= std::min(bottom_right.row_px, height_px_ - 1); ++row) {
    for (int column = std::max(top_left.column_px, 0); column <= std::min(bottom_right.column_px, width_px_ - 1);
         ++column) {
      set({column, row}, colour);
    }
  }
}

void Canvas::disc(Pixel centre, int radius_px, Rgb colour) {
  for (int row = -radius_px; row <= radius_px; ++row) {
    for (int column = -radius_px; column <= radius_px; ++column) {
      if (row * row + column * column <= radius_px * radius_px) {
        set({centre.column_px + column, centre.row_px + row}, colour);
      }
    }
  }
}

void Canvas::line(Pixel from, Pixel to, Rgb colour) {
  const int columns = to.column_px - from.column_px;
  const int rows = to.row_px - from.row_px;
  const int steps = std::max({std::abs(columns), std::abs(rows), 1});
  for (int step = 0; step <= steps; ++step) {
    const Pixel at{from.column_px + columns * step / steps, from.row_px + rows * step / steps};
    rectangle(at, {at.column_px + 1, at.row_px + 1}, colour);
  }
}

void Canvas::text(Pixel top_left, std::string_view characters, Rgb colour) {
  for (const char character : characters) {
    const auto* const glyph =
        std::find_if(kGlyphs.begin(), kGlyphs.end(), [&](const Glyph& g) { return g.character == character; });
    if (glyph != kGlyphs.end()) {
      draw_glyph(*this, top_left, *glyph, colour);
    }
    top_left.column_px += (kGlyphColumns + 1) * kGlyphScalePx;
  }
}

std::string Canvas::png() const {
  static_assert(sizeof(Rgb) == 3, "pixels are handed to libpng as they are");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_px_);
  image.height = static_cast<png_uint_32>(height_px_);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);  // to ask for the very size is to compress it twice
  std::string bytes(size, '\0');
  ODOLESS_CHECK(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels_.data(), 0, nullptr) != 0);
  bytes.resize(size);
  return bytes;
}

}  // namespace odoless

#include "tools/output/canvas.hpp"

#include <png.h>

#include "core/base/check.hpp"

namespace odoless {
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

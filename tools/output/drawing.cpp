#include "tools/output/drawing.hpp"

// Of what the library does itself: where a path ends it sets no place, and takes none.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <agg_conv_stroke.h>
#include <agg_ellipse.h>
#include <agg_gsv_text.h>
#include <agg_path_storage.h>
#include <agg_pixfmt_rgb.h>
#include <agg_rasterizer_scanline_aa.h>
#include <agg_renderer_scanline.h>
#include <agg_rendering_buffer.h>
#include <agg_scanline_p.h>
#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <iterator>

#include "core/base/check.hpp"

namespace odoless {
namespace {

// A letter's strokes, as a share of its height.
constexpr double kLetterStroke = 0.12;

std::string hex(Rgb colour) { return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue); }

std::string base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::string escaped(const std::string& words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '&':
        text += "&amp;";
        break;
      default:
        text += c;
    }
  }
  return text;
}

}  // namespace

/// Each mark onto a canvas.
class Drawing::Painter {
 public:
  explicit Painter(Canvas& canvas)
      : canvas_(canvas),
        buffer_(canvas.bytes(), static_cast<unsigned>(canvas.width_px()), static_cast<unsigned>(canvas.height_px()),
                canvas.width_px() * static_cast<int>(sizeof(Rgb))),
        format_(buffer_),
        base_(format_) {}

  void operator()(const Image& image) {
    for (int row = 0; row < image.picture.height_px(); ++row) {
      for (int column = 0; column < image.picture.width_px(); ++column) {
        canvas_.set({image.top_left.column_px + column, image.top_left.row_px + row}, image.picture.at({column, row}));
      }
    }
  }
  void operator()(const Line& line) {
    agg::path_storage path;
    for (const Spot& place : line.places) {
      path.vertices().total_vertices() == 0 ? path.move_to(place.x_px, place.y_px)
                                            : path.line_to(place.x_px, place.y_px);
    }
    stroke(path, line.stroke);
  }
  void operator()(const Rectangle& box) {
    agg::path_storage path;
    path.move_to(box.top_left.x_px, box.top_left.y_px);
    path.line_to(box.bottom_right.x_px, box.top_left.y_px);
    path.line_to(box.bottom_right.x_px, box.bottom_right.y_px);
    path.line_to(box.top_left.x_px, box.bottom_right.y_px);
    path.close_polygon();
    fill(path, box.colour, 1.0);
  }
  void operator()(const Disc& disc) {
    agg::ellipse ellipse(disc.centre.x_px, disc.centre.y_px, disc.radius_px, disc.radius_px);
    fill(ellipse, disc.colour, 1.0);
  }
  void operator()(const Text& text) {
    agg::gsv_text letters;
    letters.flip(true);
    letters.size(text.style.height_px);
    letters.text(text.words.c_str());
    const double width_px = letters.text_width();
    const double left_px = text.style.align == Align::kLeft    ? 0.0
                           : text.style.align == Align::kRight ? width_px
                                                               : 0.5 * width_px;
    letters.start_point(text.place.x_px - left_px, text.place.y_px);
    stroke(letters, {.colour = text.style.colour, .width_px = kLetterStroke * text.style.height_px});
  }

 private:
  template <class Path>
  void stroke(Path& path, const Stroke& how) {
    agg::conv_stroke<Path> outline(path);
    outline.width(how.width_px);
    outline.line_join(agg::round_join);
    outline.line_cap(agg::round_cap);
    fill(outline, how.colour, how.opacity);
  }
  template <class Path>
  void fill(Path& path, Rgb colour, double opacity) {
    rasterizer_.reset();
    rasterizer_.clip_box(0.0, 0.0, canvas_.width_px(), canvas_.height_px());
    rasterizer_.add_path(path);
    agg::render_scanlines_aa_solid(
        rasterizer_, scanline_, base_,
        agg::rgba8(colour.red, colour.green, colour.blue, static_cast<unsigned>(255.0 * opacity + 0.5)));
  }

  Canvas& canvas_;
  agg::rendering_buffer buffer_;
  agg::pixfmt_rgb24 format_;
  agg::renderer_base<agg::pixfmt_rgb24> base_;
  agg::rasterizer_scanline_aa<> rasterizer_;
  agg::scanline_p8 scanline_;
};

/// Each mark as an element.
class Drawing::SvgWriter {
 public:
  explicit SvgWriter(std::string& text) : out_(text) {}

  void operator()(const Image& image) {
    fmt::format_to(out_,
                   "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" image-rendering=\"pixelated\" "
                   "href=\"data:image/png;base64,{}\"/>\n",
                   image.top_left.column_px, image.top_left.row_px, image.picture.width_px(), image.picture.height_px(),
                   base64(image.picture.png()));
  }
  void operator()(const Line& line) {
    fmt::format_to(out_,
                   "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-opacity=\"{}\" "
                   "stroke-linejoin=\"round\" stroke-linecap=\"round\" points=\"",
                   hex(line.stroke.colour), line.stroke.width_px, line.stroke.opacity);
    for (const Spot& place : line.places) {
      fmt::format_to(out_, "{:.1f},{:.1f} ", place.x_px, place.y_px);
    }
    fmt::format_to(out_, "\"/>\n");
  }
  void operator()(const Rectangle& box) {
    fmt::format_to(out_, "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n",
                   box.top_left.x_px, box.top_left.y_px, box.bottom_right.x_px - box.top_left.x_px,
                   box.bottom_right.y_px - box.top_left.y_px, hex(box.colour));
  }
  void operator()(const Disc& disc) {
    fmt::format_to(out_, "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>\n", disc.centre.x_px,
                   disc.centre.y_px, disc.radius_px, hex(disc.colour));
  }
  void operator()(const Text& text) {
    constexpr double kEmPerHeightRatio = 1.35;  // an em against the height of a capital
    const char* const anchor = text.style.align == Align::kLeft    ? "start"
                               : text.style.align == Align::kRight ? "end"
                                                                   : "middle";
    fmt::format_to(out_,
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" font-family=\"sans-serif\" font-size=\"{:.1f}\" text-anchor=\"{}\" "
                   "fill=\"{}\">{}</text>\n",
                   text.place.x_px, text.place.y_px, kEmPerHeightRatio * text.style.height_px, anchor,
                   hex(text.style.colour), escaped(text.words));
  }

 private:
  std::back_insert_iterator<std::string> out_;
};

Drawing::Drawing(int width_px, int height_px, Rgb background)
    : width_px_(width_px), height_px_(height_px), background_(background) {
  ODOLESS_CHECK(width_px > 0 && height_px > 0);
}

void Drawing::image(Pixel top_left, Canvas picture) { marks_.emplace_back(Image{top_left, std::move(picture)}); }

void Drawing::line(std::span<const Spot> places, const Stroke& stroke) {
  marks_.emplace_back(Line{{places.begin(), places.end()}, stroke});
}

void Drawing::rectangle(Spot top_left, Spot bottom_right, Rgb colour) {
  marks_.emplace_back(Rectangle{top_left, bottom_right, colour});
}

void Drawing::disc(Spot centre, double radius_px, Rgb colour) { marks_.emplace_back(Disc{centre, radius_px, colour}); }

void Drawing::text(Spot place, std::string_view words, const TextStyle& style) {
  std::string printable;
  std::copy_if(words.begin(), words.end(), std::back_inserter(printable), [](char c) { return c >= ' ' && c <= '~'; });
  marks_.emplace_back(Text{place, std::move(printable), style});
}

Canvas Drawing::pixels() const {
  Canvas canvas(width_px_, height_px_, background_);
  Painter painter(canvas);
  for (const auto& mark : marks_) {
    std::visit(painter, mark);
  }
  return canvas;
}

std::string Drawing::svg() const {
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"{2}\"/>\n",
      width_px_, height_px_, hex(background_));
  SvgWriter writer(text);
  for (const auto& mark : marks_) {
    std::visit(writer, mark);
  }
  return text + "</svg>\n";
}

}  // namespace odoless

#include "core/ndt/score_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "core/base/hot.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReach_sigmas = 3.7;  // farther out a Gaussian rounds to nothing in 16 bits
constexpr std::int16_t kFreeBit = 1;   // the lowest bit says that a pixel is marked as free

// exp(-t) for t >= 0 as (1 - t/32)^32: smooth, monotone and made of multiplications alone.
inline float fast_exp_of_minus(float t) {
  float base = std::max(0.0F, 1.0F - t * (1.0F / 32.0F));
  base *= base;
  base *= base;
  base *= base;
  base *= base;
  return base * base;
}

// A Gaussian along one row of pixels: exponent (a u^2 + 2 b u + c) / 2 with u = u0 + i * du.
struct RowGaussian {
  float u0, du, a, b, c;
};

ODOLESS_HOT void add_gaussian_row(std::int16_t* row, int count, const RowGaussian g) {
  constexpr auto kScale = static_cast<float>(ScoreRaster::kUnit / Ndt::kGrids);
  for (int i = 0; i < count; ++i) {
    const float u = g.u0 + static_cast<float>(i) * g.du;
    const float value = kScale * fast_exp_of_minus(0.5F * ((g.a * u + 2.0F * g.b) * u + g.c));
    row[i] = static_cast<std::int16_t>(row[i] + 2 * static_cast<std::int16_t>(0.5F * value));
  }
}

ODOLESS_HOT void raise_to_gaussian_row(std::int16_t* row, int count, const RowGaussian g) {
  constexpr auto kScale = static_cast<float>(ScoreRaster::kUnit);
  for (int i = 0; i < count; ++i) {
    const float u = g.u0 + static_cast<float>(i) * g.du;
    const float value = kScale * fast_exp_of_minus(0.5F * (g.a * u * u + g.c));
    row[i] = std::max(row[i], static_cast<std::int16_t>(2 * static_cast<std::int16_t>(0.5F * value)));
  }
}

ODOLESS_HOT void mark_free_row(std::int16_t* row, int count, int penalty_1024ths) {
  constexpr int kFull = static_cast<int>(ScoreRaster::kUnit);
  for (int i = 0; i < count; ++i) {
    const int n = row[i];
    const int lowered = n - ((std::max(0, kFull - 4 * n) * penalty_1024ths) >> 10);
    row[i] = static_cast<std::int16_t>((n & kFreeBit) != 0 ? n : (lowered | kFreeBit));
  }
}

// From metres to the pixels of a square raster.
struct PixelTransform {
  float c, s, x_px, y_px;
  int side_px;
};

constexpr std::size_t kBlock = 128;

ODOLESS_HOT void pixel_indices(const float* x_m, const float* y_m, std::size_t count, const PixelTransform t,
                               std::int32_t* indices) {
  const auto limit = static_cast<float>(t.side_px - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const float column = std::min(std::max(t.c * x_m[i] - t.s * y_m[i] + t.x_px, 0.0F), limit);
    const float row = std::min(std::max(t.s * x_m[i] + t.c * y_m[i] + t.y_px, 0.0F), limit);
    indices[i] = static_cast<std::int32_t>(row) * t.side_px + static_cast<std::int32_t>(column);
  }
}

}  // namespace

ScoreRaster::ScoreRaster(const RasterParams& params)
    : params_(params),
      side_px_(2 * static_cast<int>(std::ceil(params.extent_m / params.resolution_m)) + 2),
      inverse_resolution_(1.0 / params.resolution_m) {
  ODOLESS_CHECK(parameters_in_range(params));
  pixels_.assign(static_cast<std::size_t>(side_px_) * static_cast<std::size_t>(side_px_), 0);
}

void ScoreRaster::paint(const Ndt& ndt) {
  begin_paint();
  while (!paint_slice(ndt, std::numeric_limits<int>::max())) {
  }
}

bool ScoreRaster::paint_slice(const Ndt& ndt, int pixels) {
  constexpr int kEmptied = 8;    // pixels are emptied in the time of one that is painted,
  constexpr int kCell_px = 100;  // of which the rest of a cell takes so much
  const int end = side_px_ + static_cast<int>(ndt.cells().size());
  for (; painted_ < side_px_ && pixels > 0; ++painted_, pixels -= 1 + side_px_ / kEmptied) {
    std::fill_n(pixels_.begin() + static_cast<std::ptrdiff_t>(painted_) * side_px_, side_px_, std::int16_t{0});
  }
  for (; painted_ < end && pixels > 0; ++painted_) {
    const Ndt::PlacedCell& placed = ndt.cells()[static_cast<std::size_t>(painted_ - side_px_)];
    pixels -= kCell_px + paint_cell(placed, ndt.params().cell_size_m, ndt.params().sigma_ratio_min);
  }
  return painted_ == end;
}

int ScoreRaster::paint_cell(const Ndt::PlacedCell& placed, double side_m, double sigma_ratio_min) {
  const NdtCell& cell = placed.cell;
  const NdtInformation b = mended_information(cell, params_.sigma_min_m, sigma_ratio_min);
  const double determinant = b.xx * b.yy - b.xy * b.xy;
  const double reach_x_m = kReach_sigmas * std::sqrt(b.yy / determinant);
  const double reach_y_m = kReach_sigmas * std::sqrt(b.xx / determinant);
  const double half_px = 0.5 * side_px_;
  // Pixels whose centres lie in the cell and within reach; the outermost ring stays empty for points outside.
  const auto first_px = [&](double corner_m, double mean_m, double reach_m) {
    return std::max(
        1, static_cast<int>(std::ceil(std::max(corner_m, mean_m - reach_m) * inverse_resolution_ + half_px - 0.5)));
  };
  const auto end_px = [&](double corner_m, double mean_m, double reach_m) {
    return std::min(side_px_ - 1,
                    static_cast<int>(std::ceil(std::min(corner_m + side_m, mean_m + reach_m) * inverse_resolution_ +
                                               half_px - 0.5)));
  };
  const int left = first_px(placed.corner.x_m, cell.mean.x_m, reach_x_m);
  const int right = end_px(placed.corner.x_m, cell.mean.x_m, reach_x_m);
  const int bottom = first_px(placed.corner.y_m, cell.mean.y_m, reach_y_m);
  const int top = end_px(placed.corner.y_m, cell.mean.y_m, reach_y_m);
  const double u0 = (left + 0.5 - half_px) * params_.resolution_m - cell.mean.x_m;
  for (int row = bottom; row < top; ++row) {
    const double v = (row + 0.5 - half_px) * params_.resolution_m - cell.mean.y_m;
    std::int16_t* const first =
        &pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_px_) + static_cast<std::size_t>(left)];
    add_gaussian_row(first, right - left,
                     {.u0 = static_cast<float>(u0),
                      .du = static_cast<float>(params_.resolution_m),
                      .a = static_cast<float>(b.xx),
                      .b = static_cast<float>(b.xy * v),
                      .c = static_cast<float>(b.yy * v * v)});
  }
  return std::max(0, right - left) * std::max(0, top - bottom);
}

void ScoreRaster::clear() { std::fill(pixels_.begin(), pixels_.end(), std::int16_t{0}); }

void ScoreRaster::stamp(const Point2& p_reference) {
  const Point2 p_px = in_pixels(p_reference);
  const double reach_px = kReach_sigmas * params_.sigma_min_m * inverse_resolution_;
  const auto first_px = [&](double at_px) { return std::max(1, static_cast<int>(std::ceil(at_px - reach_px - 0.5))); };
  const auto end_px = [&](double at_px) {
    return std::min(side_px_ - 1, static_cast<int>(std::floor(std::min<double>(at_px + reach_px, side_px_) - 0.5)) + 1);
  };
  if (!(p_px.x_m > -reach_px && p_px.y_m > -reach_px && p_px.x_m < side_px_ + reach_px &&
        p_px.y_m < side_px_ + reach_px)) {
    return;
  }
  const int left = first_px(p_px.x_m);
  const int right = end_px(p_px.x_m);
  const double px_per_sigma = params_.sigma_min_m * inverse_resolution_;
  const auto a = static_cast<float>(1.0 / (px_per_sigma * px_per_sigma));
  for (int row = first_px(p_px.y_m); row < end_px(p_px.y_m) && left < right; ++row) {
    const auto v = static_cast<float>(row + 0.5 - p_px.y_m);
    raise_to_gaussian_row(
        &pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_px_) + static_cast<std::size_t>(left)],
        right - left, {.u0 = static_cast<float>(left + 0.5 - p_px.x_m), .du = 1.0F, .a = a, .b = 0.0F, .c = a * v * v});
  }
}

void ScoreRaster::mark_free(const Point2& p_reference, double penalty) {
  const Point2 p_px = in_pixels(p_reference);
  if (p_px.x_m >= 1.0 && p_px.y_m >= 1.0 && p_px.x_m < side_px_ - 1 && p_px.y_m < side_px_ - 1) {
    const auto left = std::floor(p_px.x_m);
    mark_span(static_cast<int>(p_px.y_m), left, left + 1.0, penalty);
  }
}

bool ScoreRaster::is_free(const Point2& p_reference) const {
  const Point2 p_px = in_pixels(p_reference);
  return p_px.x_m >= 1.0 && p_px.y_m >= 1.0 && p_px.x_m < side_px_ - 1 && p_px.y_m < side_px_ - 1 &&
         (pixels_[static_cast<std::size_t>(p_px.y_m) * static_cast<std::size_t>(side_px_) +
                  static_cast<std::size_t>(p_px.x_m)] &
          kFreeBit) != 0;
}

void ScoreRaster::mark_free(const ScanFrame& scan, const Pose2& reference_T_scan, double margin_m, double penalty) {
  const double half_step_rad = 0.5 * std::abs(scan.angle_step_rad());
  const int beams = std::min(scan.size(), static_cast<int>(2.0 * kPi / std::abs(scan.angle_step_rad()) + 1e-6));
  const Point2 apex{reference_T_scan.x_m, reference_T_scan.y_m};
  for (int i = 0; i < beams; ++i) {
    if (!scan.is_return(i)) {
      continue;
    }
    double radius_m = scan.range_m(i);
    for (const int neighbour : {i - 1, i + 1}) {
      if (neighbour >= 0 && neighbour < scan.size() && scan.is_return(neighbour)) {
        radius_m = std::min(radius_m, scan.range_m(neighbour));
      }
    }
    radius_m -= margin_m;
    if (radius_m > params_.resolution_m) {
      const double middle_rad = reference_T_scan.yaw_rad + scan.angle_rad(i);
      mark_wedge(middle_rad - half_step_rad, middle_rad + half_step_rad, radius_m, apex, penalty);
    }
  }
}

void ScoreRaster::mark_wedge(double start_rad, double end_rad, double radius_m, const Point2& apex, double penalty) {
  const double turns = std::floor(start_rad / (2.0 * kPi));
  double from_rad = start_rad - turns * 2.0 * kPi;
  const double to_rad = end_rad - turns * 2.0 * kPi;
  // At most two half turns hold a wedge of one beam, three after the wrap.
  for (int half_turn = static_cast<int>(from_rad / kPi); half_turn <= 2 && from_rad < to_rad; ++half_turn) {
    const double base_rad = half_turn * kPi;
    const double until_rad = std::min(to_rad, base_rad + kPi);
    const double a_rad = from_rad - base_rad;
    const double b_rad = until_rad - base_rad;
    if (half_turn % 2 == 0) {
      mark_half_wedge({a_rad, b_rad, radius_m}, apex, 1.0, penalty);
    } else {
      mark_half_wedge({kPi - b_rad, kPi - a_rad, radius_m}, apex, -1.0, penalty);
    }
    from_rad = until_rad;
  }
}

void ScoreRaster::mark_half_wedge(const HalfWedge& wedge, const Point2& apex, double mirror, double penalty) {
  const auto [start_rad, end_rad, radius_m] = wedge;
  const bool has_right_edge = start_rad > 1e-6;  // else the wedge begins along the row
  const bool has_left_edge = end_rad < kPi - 1e-6;
  const double cot_start = has_right_edge ? math::cos(start_rad) / math::sin(start_rad) : 0.0;
  const double cot_end = has_left_edge ? math::cos(end_rad) / math::sin(end_rad) : 0.0;
  const bool has_top = start_rad < 0.5 * kPi && end_rad > 0.5 * kPi;
  const double height_m = radius_m * (has_top ? 1.0 : std::max(math::sin(start_rad), math::sin(end_rad)));
  const double half_px = 0.5 * side_px_;
  const double apex_row_px = apex.y_m * inverse_resolution_ + half_px - 0.5;
  const double apex_column_px = apex.x_m * inverse_resolution_ + half_px;
  // Rows on this side of the apex, its own among them, as far as the wedge and the raster reach.
  const double height_px = mirror * height_m * inverse_resolution_;
  const double lowest_px = std::max(0.0, std::min(apex_row_px, apex_row_px + height_px));
  const double highest_px = std::min(side_px_ - 1.0, std::max(apex_row_px, apex_row_px + height_px));
  for (int row = static_cast<int>(std::ceil(lowest_px)); row <= highest_px; ++row) {
    const double v_m = std::abs(row - apex_row_px) * params_.resolution_m;
    const double reach_m = std::sqrt(std::max(0.0, radius_m * radius_m - v_m * v_m));
    const double left_m = has_left_edge ? std::max(-reach_m, v_m * cot_end) : -reach_m;
    const double right_m = has_right_edge ? std::min(reach_m, v_m * cot_start) : reach_m;
    mark_span(row, apex_column_px + left_m * inverse_resolution_, apex_column_px + right_m * inverse_resolution_,
              penalty);
  }
}

void ScoreRaster::mark_span(int row, double from_px, double to_px, double penalty) {
  const int from = std::max(1, static_cast<int>(std::ceil(std::max(0.0, from_px) - 0.5)));
  const int to = std::min(side_px_ - 1, static_cast<int>(std::ceil(std::min<double>(side_px_, to_px) - 0.5)));
  if (row > 0 && row < side_px_ - 1 && from < to) {
    std::int16_t* const first =
        &pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_px_) + static_cast<std::size_t>(from)];
    mark_free_row(first, to - from, static_cast<int>(penalty * 1024.0));
  }
}

double ScoreRaster::score(std::span<const float> x_m, std::span<const float> y_m,
                          const Pose2& reference_T_points) const {
  const double half_px = 0.5 * side_px_;
  const PixelTransform transform{static_cast<float>(math::cos(reference_T_points.yaw_rad) * inverse_resolution_),
                                 static_cast<float>(math::sin(reference_T_points.yaw_rad) * inverse_resolution_),
                                 static_cast<float>(reference_T_points.x_m * inverse_resolution_ + half_px),
                                 static_cast<float>(reference_T_points.y_m * inverse_resolution_ + half_px), side_px_};
  std::array<std::int32_t, kBlock> indices;
  std::int32_t sum = 0;
  for (std::size_t start = 0; start < x_m.size(); start += kBlock) {
    const std::size_t count = std::min(kBlock, x_m.size() - start);
    pixel_indices(x_m.data() + start, y_m.data() + start, count, transform, indices.data());
    for (std::size_t i = 0; i < count; ++i) {
      sum += pixels_[static_cast<std::size_t>(indices[i])];
    }
  }
  return sum / kUnit;
}

double ScoreRaster::at(const Point2& p_reference) const {
  const auto x = static_cast<float>(p_reference.x_m);
  const auto y = static_cast<float>(p_reference.y_m);
  return score({&x, 1}, {&y, 1}, Pose2{});
}

}  // namespace odoless

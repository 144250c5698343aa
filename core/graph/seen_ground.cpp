#include "core/graph/seen_ground.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kNear_m = 6.0;
constexpr double kCell_m = 0.25;
constexpr double kStep_m = 0.5 * kCell_m;  // along a beam

}  // namespace

class SeenGround::Cell {
 public:
  Cell(int part, double x_m, double y_m) : part_(part), column_(index(x_m)), row_(index(y_m)) {}
  Cell(std::int64_t block, int bit)
      : part_(block / (kBlocks * kBlocks)),
        column_(block % kBlocks * kSide + bit % kSide),
        row_(block / kBlocks % kBlocks * kSide + bit / kSide) {}

  [[nodiscard]] std::int64_t block() const { return (part_ * kBlocks + row_ / kSide) * kBlocks + column_ / kSide; }
  [[nodiscard]] std::uint64_t bit() const { return std::uint64_t{1} << (row_ % kSide * kSide + column_ % kSide); }
  [[nodiscard]] Cell next_to(int columns, int rows) const {
    Cell other = *this;
    other.column_ += columns;
    other.row_ += rows;
    return other;
  }

 private:
  static constexpr std::int64_t kSide = 8;                        // of a block, in cells
  static constexpr std::int64_t kBlocks = std::int64_t{1} << 20;  // of the plane's side: 2,000 km

  static std::int64_t index(double at_m) {
    return static_cast<std::int64_t>(std::floor(at_m / kCell_m)) + kBlocks * kSide / 2;
  }

  std::int64_t part_;
  std::int64_t column_;  // from the plane's edge
  std::int64_t row_;
};

void SeenGround::see(int part, const KeyframeStore& store, int keyframe, const Pose2& map_T_scan) {
  const Keyframe& of = store[keyframe];
  const std::span<const BeamCode> codes = store.codes(keyframe);
  const double step_rad = std::max(std::abs(of.angle_step_rad), 1e-4);
  const auto stride = static_cast<std::size_t>(std::max(1.0, kCell_m / kNear_m / step_rad));
  for (std::size_t i = 0; i < codes.size(); i += stride) {
    const double angle_rad = map_T_scan.yaw_rad + of.start_angle_rad + of.angle_step_rad * static_cast<double>(i);
    const Point2 direction{math::cos(angle_rad), math::sin(angle_rad)};
    const double reach_m = std::min(static_cast<double>(range_of(codes[i])), kNear_m);
    const int steps = static_cast<int>(std::ceil(reach_m / kStep_m));
    for (int step = 0; step < steps; ++step) {
      const double way_m = kStep_m * step;
      const Cell cell(part, map_T_scan.x_m + way_m * direction.x_m, map_T_scan.y_m + way_m * direction.y_m);
      blocks_[cell.block()] |= cell.bit();
    }
  }
}

void SeenGround::add(const SeenGround& other) {
  for (const auto& [block, bits] : other.blocks_) {
    blocks_[block] |= bits;
  }
}

double SeenGround::share_in(const SeenGround& other) const {
  std::int64_t all = 0;
  std::int64_t seen = 0;
  for (const auto& [block, bits] : blocks_) {
    for (std::uint64_t left = bits; left != 0; left &= left - 1) {
      ++all;
      seen += other.has_near(Cell(block, std::countr_zero(left))) ? 1 : 0;
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(all);
}

bool SeenGround::has(const Cell& cell) const {
  const auto found = blocks_.find(cell.block());
  return found != blocks_.end() && (found->second & cell.bit()) != 0;
}

bool SeenGround::has_near(const Cell& cell) const {
  for (const int rows : {0, -1, 1}) {
    for (const int columns : {0, -1, 1}) {
      if (has(cell.next_to(columns, rows))) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace odoless

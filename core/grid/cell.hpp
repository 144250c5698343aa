#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/math/elementary.hpp"

namespace odoless {

/// What the beams said of one cell: the published opacity model of DP-SLAM [eliazar2004dpslam2; method 6], the way that
/// beams travelled in it and how often one stopped there. Four bytes, half of two floats: cells are nearly all of the
/// memory that a filter needs.
///
/// Way is counted in 32nds of the cell's width. A counter that overflows (after some 1500 beams) halves both, so the
/// ratio stays and the newer beams count for more.
class Cell {
 public:
  static constexpr int kParts = 32;  ///< of the cell's width

  constexpr Cell() = default;
  constexpr Cell(std::uint16_t way_parts, std::uint16_t hits) : packed_(std::uint32_t{hits} << 16U | way_parts) {}

  [[nodiscard]] bool is_unknown() const { return packed_ == 0; }
  /// Seen, and no beam ever stopped in it.
  [[nodiscard]] bool is_free() const { return packed_ - 1U < kWayMax; }
  [[nodiscard]] std::uint32_t hits() const { return packed_ >> 16U; }
  [[nodiscard]] std::uint32_t way_parts() const { return packed_ & kWayMax; }

  /// 1 / rho = hits / way: the rate at which beams stop per cell's width. The way counts as at least `rho_min_parts`
  /// per hit, lest a beam that stopped where it entered make a wall that nothing passes.
  [[nodiscard]] float stops_per_cell(float rho_min_parts) const {
    const auto hits_f = static_cast<float>(hits());
    return kParts * hits_f / std::max(static_cast<float>(way_parts()), hits_f * rho_min_parts);
  }

  /// A beam travelled this way in the cell, at most a diagonal.
  void pass(std::uint32_t parts) {
    if (way_parts() + parts > kWayMax) {
      *this = halved();
    }
    packed_ += parts;
  }
  /// A beam stopped in the cell.
  void hit() {
    if (hits() == kHitsMax) {
      *this = halved();
    }
    packed_ += 1U << 16U;
  }

  /// Probability in percent that a beam stops on a cell's width of way. Not for unknown cells.
  [[nodiscard]] int occupancy_percent(float rho_min_parts) const {
    return static_cast<int>(std::lround(-100.0 * math::expm1(-static_cast<double>(stops_per_cell(rho_min_parts)))));
  }

  friend bool operator==(const Cell&, const Cell&) = default;

 private:
  static constexpr std::uint32_t kWayMax = 0xFFFF;
  static constexpr std::uint32_t kHitsMax = 0xFFFF;

  /// Hits are rounded up: what once stopped a beam never looks as if it had not.
  [[nodiscard]] Cell halved() const {
    return {static_cast<std::uint16_t>(way_parts() / 2), static_cast<std::uint16_t>((hits() + 1) / 2)};
  }

  std::uint32_t packed_ = 0;
};

}  // namespace odoless

#pragma once

#include <cstddef>
#include <cstdint>

namespace odoless {

/// Column and row of a cell in one number, so that a step along a beam is one addition and the question whether it led
/// into another tile one comparison (BM_GridWalk, BM_LslamUpdate). Each may be -2^30 .. 2^30 - 1.
class GridCell {
 public:
  constexpr GridCell(int column, int row) : packed_(half(row + kBias) << kRowShift | half(column + kBias)) {}

  [[nodiscard]] constexpr int column() const { return static_cast<int>(static_cast<std::uint32_t>(packed_)) - kBias; }
  [[nodiscard]] constexpr int row() const { return static_cast<int>(packed_ >> kRowShift) - kBias; }

  /// What to add to step by one column or row.
  [[nodiscard]] static constexpr std::uint64_t step(int columns, int rows) {
    return (static_cast<std::uint64_t>(rows) << kRowShift) + static_cast<std::uint64_t>(columns);
  }
  constexpr void add(std::uint64_t step) { packed_ += step; }

  /// The same number for all cells of one tile of 2^k x 2^k cells, another for all others.
  template <int k>
  [[nodiscard]] constexpr std::uint64_t tile() const {
    constexpr std::uint64_t kHalf = ~std::uint64_t{0} >> kRowShift << k & (~std::uint64_t{0} >> kRowShift);
    return packed_ & (kHalf << kRowShift | kHalf);
  }
  /// Index of the cell within that tile, row by row.
  template <int k>
  [[nodiscard]] constexpr std::size_t index_in_tile() const {
    constexpr std::uint64_t kInside = (std::uint64_t{1} << k) - 1;
    return (packed_ & kInside) | ((packed_ >> (kRowShift - k)) & (kInside << k));
  }

 private:
  static constexpr int kRowShift = 32;
  static constexpr int kBias = 1 << 30;  // a multiple of every tile's side; keeps both halves positive

  static constexpr std::uint64_t half(int biased) { return static_cast<std::uint32_t>(biased); }

  std::uint64_t packed_;
};

}  // namespace odoless

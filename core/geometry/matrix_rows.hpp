#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace odoless {

/// A square matrix, row by row: unlike Eigen's it can be copied as bytes.
template <std::size_t kSize>
using MatrixRows = std::array<double, kSize * kSize>;

template <int kSize>
[[nodiscard]] Eigen::Matrix<double, kSize, kSize> matrix_of(const MatrixRows<static_cast<std::size_t>(kSize)>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data());
}

template <int kSize>
[[nodiscard]] MatrixRows<static_cast<std::size_t>(kSize)> rows_of(const Eigen::Matrix<double, kSize, kSize>& matrix) {
  MatrixRows<static_cast<std::size_t>(kSize)> rows;
  Eigen::Map<Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(rows.data()) = matrix;
  return rows;
}

template <std::size_t kSize>
[[nodiscard]] constexpr MatrixRows<kSize> identity_rows() {
  MatrixRows<kSize> rows{};
  for (std::size_t i = 0; i < kSize; ++i) {
    rows[i * (kSize + 1)] = 1.0;
  }
  return rows;
}

}  // namespace odoless

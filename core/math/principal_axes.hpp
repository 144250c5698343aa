#pragma once

#include <Eigen/Core>

namespace odoless::math {

/// What a symmetric matrix of N x N is along its own axes: `axes * values.asDiagonal() * axes.transpose()`.
template <int N>
struct PrincipalAxes {
  Eigen::Matrix<double, N, 1> values;  ///< eigenvalues, ascending
  Eigen::Matrix<double, N, N> axes;    ///< eigenvectors of length 1, each a column; the sign of each is either
};

/// Of a symmetric matrix, whose lower triangle alone is read; N is 2 or 3. Eigen's solver, behind a function because
/// each source that names it takes seconds more to compile.
///
/// Real time: no allocation, at most 30 rounds per row.
template <int N>
[[nodiscard]] PrincipalAxes<N> principal_axes(const Eigen::Matrix<double, N, N>& symmetric);

}  // namespace odoless::math

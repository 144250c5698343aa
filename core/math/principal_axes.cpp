#include "core/math/principal_axes.hpp"

#include <Eigen/Eigenvalues>

namespace odoless::math {

template <int N>
PrincipalAxes<N> principal_axes(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template PrincipalAxes<2> principal_axes<2>(const Eigen::Matrix2d&);
template PrincipalAxes<3> principal_axes<3>(const Eigen::Matrix3d&);

}  // namespace odoless::math

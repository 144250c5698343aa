#include "core/math/principal_axes.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace odoless {
namespace {

double entry() { return 0.01 * *rc::gen::inRange(-100'000, 100'000); }

template <int N>
void expect_axes_of_any_matrix() {
  Eigen::Matrix<double, N, N> symmetric;
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column <= row; ++column) {
      symmetric(row, column) = symmetric(column, row) = entry();
    }
  }
  const auto found = math::principal_axes<N>(symmetric);
  RC_ASSERT((found.axes.transpose() * found.axes).isIdentity(1e-12));
  RC_ASSERT((found.axes * found.values.asDiagonal() * found.axes.transpose() - symmetric).norm() <=
            1e-12 * symmetric.norm());
  for (int i = 1; i < N; ++i) {
    RC_ASSERT(found.values(i - 1) <= found.values(i));
  }

  Eigen::Matrix<double, N, N> upper_changed = symmetric;
  upper_changed.template triangularView<Eigen::StrictlyUpper>().setConstant(entry());
  RC_ASSERT(math::principal_axes<N>(upper_changed).values == found.values);
}

RC_GTEST_PROP(PrincipalAxes, MakeUpASymmetricMatrixOfTwo, ()) { expect_axes_of_any_matrix<2>(); }
RC_GTEST_PROP(PrincipalAxes, MakeUpASymmetricMatrixOfThree, ()) { expect_axes_of_any_matrix<3>(); }

TEST(PrincipalAxes, OfAnEllipseAtAnAngle) {
  const Eigen::Vector2d along(0.6, 0.8);
  const Eigen::Vector2d across(-0.8, 0.6);
  const auto found = math::principal_axes<2>(9.0 * along * along.transpose() + 4.0 * across * across.transpose());
  EXPECT_NEAR(found.values(0), 4.0, 1e-14);
  EXPECT_NEAR(found.values(1), 9.0, 1e-14);
  EXPECT_NEAR(std::abs(found.axes.col(1).dot(along)), 1.0, 1e-15);
}

}  // namespace
}  // namespace odoless

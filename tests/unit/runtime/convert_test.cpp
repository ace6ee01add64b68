#include "nodes/runtime/convert.hpp"

#include <gtest/gtest.h>

namespace voxtouch::runtime {
namespace {

/// Every number of the triangle names its place: row 1 column 2 is 12, row 6 column 6 is 66.
Mat6 labelled() {
  Mat6 m;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      m(row, column) = 10 * std::min(row, column) + std::max(row, column) + 11;
  return m;
}

TEST(Convert, AStiffnessMatrixIsItsUpperTriangleByRows) {
  msg::ContactState state{};
  to_msg(labelled(), state.stiffness);
  const std::vector<double> expected = {11, 12, 13, 14, 15, 16, 22, 23, 24, 25, 26,
                                        33, 34, 35, 36, 44, 45, 46, 55, 56, 66};
  EXPECT_EQ(std::vector<double>(std::begin(state.stiffness), std::end(state.stiffness)), expected);
}

TEST(Convert, AStiffnessMatrixComesBackWholeAndSymmetric) {
  msg::ContactState state{};
  to_msg(labelled(), state.stiffness);
  EXPECT_EQ(from_msg(state.stiffness), labelled());
}

TEST(Convert, OnlyTheUpperTriangleTravels) {
  Mat6 lopsided = labelled();
  lopsided.triangularView<Eigen::StrictlyLower>().setConstant(-1.0);
  msg::ContactState state{};
  to_msg(lopsided, state.stiffness);
  EXPECT_EQ(from_msg(state.stiffness), labelled());
}

}  // namespace
}  // namespace voxtouch::runtime

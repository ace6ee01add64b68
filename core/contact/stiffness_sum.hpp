#pragma once
/// Sums of w J' J over the points with force, J = [u', (arm x u)']: the part of -d(wrench)/d(pose)
/// caused by the depths.
#include <array>

#include "core/types/geometry.hpp"

namespace voxtouch::contact {

/// For points with individual directions. Adds in the order of the calls; real-time safe.
class StiffnessSum {
 public:
  /// Adds a point with depth u . (c - x) and force along u (at most of unit length); `arm` from the
  /// tool's origin [m], W axes; `weight` as Hit::weight.
  void add(const Vec3& arm, const Vec3& u, double weight = 1.0) noexcept {
    const Vec3 lever = arm.cross(u);
    const std::array<double, 6> j = {u.x(), u.y(), u.z(), lever.x(), lever.y(), lever.z()};
    std::size_t n = 0;
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = row; column < 6; ++column)
        sums_[n++] += weight * (j[row] * j[column]);
  }
  /// Whether any point with force was added.
  bool any() const noexcept { return sums_[0] > 0.0 || sums_[6] > 0.0 || sums_[11] > 0.0; }
  /// The upper triangle by rows.
  std::array<double, 21>& entries() noexcept { return sums_; }
  /// Adds the sum times `stiffness` (for unit weight); the matrix stays exactly symmetric.
  void add_to(double stiffness, Mat6& matrix) const noexcept {
    std::size_t n = 0;
    for (Eigen::Index row = 0; row < 6; ++row)
      for (Eigen::Index column = row; column < 6; ++column) {
        matrix(row, column) += stiffness * sums_[n++];
        matrix(column, row) = matrix(row, column);
      }
  }

 private:
  std::array<double, 21> sums_{};
};

/// For points with one common direction m: arm x m is linear in the arm, so the moments of the arms
/// suffice, which halves the work per point.
class CommonDirectionSum {
 public:
  /// Sums of the weights w: w; w arm; then w arm arm', the upper triangle by rows.
  static constexpr std::size_t kSums = 10;
  CommonDirectionSum() = default;
  explicit CommonDirectionSum(const double (&sums)[kSums]) noexcept
      : weights_(sums[0]),
        arms_(sums[1], sums[2], sums[3]),
        xx_(sums[4]),
        xy_(sums[5]),
        xz_(sums[6]),
        yy_(sums[7]),
        yz_(sums[8]),
        zz_(sums[9]) {}

  /// Adds one point at `arm` from the tool's origin [m], W axes. Real-time safe.
  void add(const Vec3& arm, double weight = 1.0) noexcept {
    const Vec3 weighed = weight * arm;
    weights_ += weight;
    arms_ += weighed;
    xx_ += weighed.x() * arm.x(), xy_ += weighed.x() * arm.y(), xz_ += weighed.x() * arm.z();
    yy_ += weighed.y() * arm.y(), yz_ += weighed.y() * arm.z(), zz_ += weighed.z() * arm.z();
  }
  bool any() const noexcept { return weights_ > 0.0; }
  /// The sum times `stiffness` (for unit weight) for the unit direction `m`; exactly symmetric.
  Mat6 matrix(double stiffness, const Vec3& m) const noexcept {
    Mat6 out = Mat6::Zero();
    if (!any())
      return out;
    Mat3 moments, lever;  // lever * arm = arm x m
    moments << xx_, xy_, xz_, xy_, yy_, yz_, xz_, yz_, zz_;
    lever << 0.0, m.z(), -m.y(), -m.z(), 0.0, m.x(), m.y(), -m.x(), 0.0;
    out.topLeftCorner<3, 3>() = (stiffness * weights_) * (m * m.transpose());
    out.topRightCorner<3, 3>() = stiffness * (m * arms_.cross(m).transpose());
    out.bottomRightCorner<3, 3>() = stiffness * (lever * moments * lever.transpose());
    out.triangularView<Eigen::StrictlyLower>() = out.transpose();
    return out;
  }

 private:
  double weights_ = 0.0;
  Vec3 arms_ = Vec3::Zero();
  double xx_ = 0.0, xy_ = 0.0, xz_ = 0.0, yy_ = 0.0, yz_ = 0.0, zz_ = 0.0;
};

}  // namespace voxtouch::contact

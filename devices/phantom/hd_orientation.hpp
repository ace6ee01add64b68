#pragma once
/// The rotation in a transform of the library, which is column-major and not quite orthonormal.
#include <Eigen/LU>

#include "core/types/geometry.hpp"

namespace voxtouch::phantom {

/// Of any entry of R^T R from the identity.
inline constexpr double kOrthonormalWithin = 0.05;

/// The rotation nearest to the upper left block of `transform16`, as a unit quaternion with w of
/// either sign; false and `out` left as it was where the block is not finite, mirrors, or is
/// further from a rotation than `kOrthonormalWithin`. Nearest in the Frobenius norm: the polar
/// factor, by Newton's iteration X := (X + X^-T) / 2 (Higham), which squares the error each time.
/// Real-time safe.
inline bool orientation_of(const double* transform16, Quat& out) noexcept {
  Mat3 x = Eigen::Map<const Eigen::Matrix4d>(transform16).topLeftCorner<3, 3>();
  if (!x.allFinite() || !(x.determinant() > 0.0))
    return false;
  if (!((x.transpose() * x - Mat3::Identity()).cwiseAbs().maxCoeff() <= kOrthonormalWithin))
    return false;
  for (int i = 0; i < 4; ++i)
    x = 0.5 * (x + Mat3(x.inverse().transpose()));
  out = Quat(x).normalized();
  return true;
}

}  // namespace voxtouch::phantom

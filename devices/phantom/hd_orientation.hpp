#pragma once
/// Extracts the rotation of a transform of the library, which is column-major and not exactly
/// orthonormal.
#include <Eigen/LU>

#include "core/types/geometry.hpp"

namespace voxtouch::phantom {

/// Tolerance of any entry of R^T R minus the identity.
inline constexpr double kOrthonormalWithin = 0.05;

/// The rotation nearest to the upper left block of `transform16`, as a unit quaternion with w of
/// either sign. Real-time safe.
/// Returns false, with `out` unchanged, if the block is not finite, is a reflection, or deviates
/// from a rotation by more than `kOrthonormalWithin`. Nearest in the Frobenius norm: the polar
/// factor, by Newton's iteration X := (X + X^-T) / 2 (Higham), which converges quadratically.
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

#pragma once
/// Trilinear interpolation of the eight nodes of a voxel, for one point and for many.
#include "core/types/clones.hpp"

namespace voxtouch::voxmap {

/// A value and its derivatives along the axes, for a voxel of edge 1.
struct Interpolated {
  double value, along_x, along_y, along_z;
};

/// Interpolates from `a` to `b` as `s` goes from 0 to 1.
VOXTOUCH_INLINE double mix(double a, double b, double s) noexcept { return a + s * (b - a); }

/// `d`: the nodes, x first, then y, then z; x, y, z: position within the voxel, 0 to 1. Continuous
/// from voxel to voxel. Real-time safe.
VOXTOUCH_INLINE Interpolated interpolated(const double (&d)[8], double x, double y,
                                          double z) noexcept {
  const double x00 = mix(d[0], d[1], x), x10 = mix(d[2], d[3], x), x01 = mix(d[4], d[5], x),
               x11 = mix(d[6], d[7], x);
  const double xy0 = mix(x00, x10, y), xy1 = mix(x01, x11, y);
  return {mix(xy0, xy1, z),
          mix(mix(d[1] - d[0], d[3] - d[2], y), mix(d[5] - d[4], d[7] - d[6], y), z),
          mix(x10 - x00, x11 - x01, z), xy1 - xy0};
}

}  // namespace voxtouch::voxmap

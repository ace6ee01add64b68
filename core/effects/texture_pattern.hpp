#pragma once
/// Height maps for textures: pure functions of a position in W, equal on every machine.
#include "core/types/geometry.hpp"

namespace voxtouch::effects {

/// A height and its slope. Both patterns are scaled to |slope| <= 1: the height is in metres for
/// slopes of at most 45 degrees.
struct PatternSample {
  double height_m = 0.0;
  Vec3 slope = Vec3::Zero();
};

/// sin(2 pi d.x / wavelength) wavelength / (2 pi), with a unit `direction` d. Real-time safe.
PatternSample grating_at(const Vec3& x, double wavelength_m, const Vec3& direction) noexcept;
/// Values in -1..1 hashed from the corners of a lattice of half a wavelength, blended by the
/// quintic of Perlin (2002). Continuous with its second derivative, and isotropic apart from the
/// lattice. Real-time safe.
PatternSample noise_at(const Vec3& x, double wavelength_m) noexcept;

/// Bound of the spectral norm of the heights' second derivatives, times the wavelength. Grating: 2
/// pi. Noise: cells of half a wavelength, 14.0625 of a cell's values relative to its steepest slope
/// of 3.75, by search over all signs of its corners.
inline constexpr double kGratingBend = 6.283185307179587;
inline constexpr double kNoiseSteepest = 3.75, kNoiseBend = 2.0 * 14.0625 / kNoiseSteepest;

}  // namespace voxtouch::effects

#include "core/effects/texture_pattern.hpp"

#include <cmath>
#include <cstdint>

namespace voxtouch::effects {
namespace {

/// Finaliser of splitmix64 (Steele, Lea, Flood 2014), chained over the corner's three numbers.
std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// -1..1 for a corner of the lattice.
double value_at(std::int64_t i, std::int64_t j, std::int64_t k) noexcept {
  const std::uint64_t bits =
      mixed(mixed(mixed(static_cast<std::uint64_t>(i)) ^ static_cast<std::uint64_t>(j)) ^
            static_cast<std::uint64_t>(k));
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
}

}  // namespace

PatternSample grating_at(const Vec3& x, double wavelength_m, const Vec3& direction) noexcept {
  const double wave = 2.0 * M_PI / wavelength_m;
  const double phase = 2.0 * M_PI * std::remainder(direction.dot(x) / wavelength_m, 1.0);
  return {std::sin(phase) / wave, std::cos(phase) * direction};
}

PatternSample noise_at(const Vec3& x, double wavelength_m) noexcept {
  constexpr double kFarthest = 1e15;  // cells: larger doubles have no fractional part
  const double cell = 0.5 * wavelength_m;
  const Vec3 u = x / cell;
  if (!(u.cwiseAbs().maxCoeff() < kFarthest))
    return {};
  const Vec3 base(std::floor(u.x()), std::floor(u.y()), std::floor(u.z()));
  const Vec3 t = u - base;
  double blend[3][2], slope[3][2];
  for (int a = 0; a < 3; ++a) {
    const double s = t[a];
    blend[a][1] = s * s * s * (s * (6.0 * s - 15.0) + 10.0), blend[a][0] = 1.0 - blend[a][1];
    slope[a][1] = 30.0 * s * s * (s - 1.0) * (s - 1.0), slope[a][0] = -slope[a][1];
  }
  PatternSample out;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        const double value = value_at(static_cast<std::int64_t>(base.x()) + i,
                                      static_cast<std::int64_t>(base.y()) + j,
                                      static_cast<std::int64_t>(base.z()) + k);
        out.height_m += value * blend[0][i] * blend[1][j] * blend[2][k];
        out.slope += value * Vec3(slope[0][i] * blend[1][j] * blend[2][k],
                                  blend[0][i] * slope[1][j] * blend[2][k],
                                  blend[0][i] * blend[1][j] * slope[2][k]);
      }
  out.height_m *= cell / kNoiseSteepest;
  out.slope /= kNoiseSteepest;
  return out;
}

}  // namespace voxtouch::effects

#pragma once
/// Unit normals with ten bits per component: four bytes for a hit that certainly has no force,
/// instead of 24.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxtouch::contact::packed_normals {

/// A component is stored as a multiple of this step, x in the upper ten bits of the word, then y,
/// then z. A word shifted to a component's bits and read as a signed number is that component
/// within one step, whatever the lower bits are.
inline constexpr double kStep = 1.0 / 511.0;
inline constexpr double kWordStep = kStep / (1 << 22);  ///< step of the word as a number
/// Largest error of a normal read in this way: one step in each component.
inline constexpr double kMaxOff = kStep * 1.7321;

inline std::uint32_t packed(double x, double y, double z) noexcept {
  const auto bits = [](double component) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(component / kStep))) &
           1023U;
  };
  return bits(x) << 22 | bits(y) << 12 | bits(z) << 2;
}

/// Packs all normals; empty if a component exceeds -1..1 by more than the rounding of a unit
/// vector. Allocates.
inline std::vector<std::uint32_t> all_packed(const std::vector<double>& x,
                                             const std::vector<double>& y,
                                             const std::vector<double>& z) {
  for (const std::vector<double>* const column : {&x, &y, &z})
    if (!std::all_of(column->begin(), column->end(),
                     [](double component) { return std::abs(component) <= 1.0 + 1e-9; }))
      return {};
  std::vector<std::uint32_t> out(x.size());
  for (std::size_t n = 0; n < out.size(); ++n)
    out[n] = packed(x[n], y[n], z[n]);
  return out;
}

}  // namespace voxtouch::contact::packed_normals

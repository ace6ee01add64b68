#pragma once
/// Typical users' parts: a bracket of 220 triangles, a peg of 192, a gear, a lathed knob of any
/// number. Closed, outward, in metres.
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::test {

struct Part {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// An outline in the plane, counterclockwise, that `middle` sees all of, from z = 0 to `height`.
inline Part extruded(const std::vector<std::array<double, 2>>& outline,
                     const std::array<double, 2>& middle, double height) {
  Part part;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, height})
    for (const auto& [x, y] : outline)
      part.vertices.emplace_back(x, y, z);
  for (const double z : {0.0, height})
    part.vertices.emplace_back(middle[0], middle[1], z);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    part.triangles.push_back({2 * n, next, k});
    part.triangles.push_back({2 * n + 1, n + k, n + next});
    part.triangles.push_back({k, next, n + next});
    part.triangles.push_back({k, n + next, n + k});
  }
  return part;
}

/// Solid of revolution about z: `profile` of radius and height from the lower to the upper tip,
/// without the tips.
inline Part turned(const std::vector<std::array<double, 2>>& profile, double low, double high,
                   std::uint32_t around) {
  Part part;
  for (const auto& [radius, z] : profile)
    for (std::uint32_t k = 0; k < around; ++k) {
      const double a = 2.0 * std::numbers::pi * k / around;
      part.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
    }
  const auto tip = static_cast<std::uint32_t>(part.vertices.size());
  part.vertices.emplace_back(0, 0, low), part.vertices.emplace_back(0, 0, high);
  const auto rings = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t next = (k + 1) % around, top = (rings - 1) * around;
    part.triangles.push_back({tip, next, k});
    part.triangles.push_back({tip + 1, top + k, top + next});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      const std::uint32_t a = r * around + k, b = r * around + next;
      part.triangles.push_back({a, b, b + around});
      part.triangles.push_back({a, b + around, a + around});
    }
  }
  return part;
}

/// Two legs of 60 and 40 mm, 8 mm thick, 30 mm wide, with a fillet of 6 mm and rounded ends.
inline Part bracket() {
  std::vector<std::array<double, 2>> outline;
  const auto arc = [&](double x, double y, double radius, double from_deg, double to_deg,
                       int steps) {
    for (int n = 0; n <= steps; ++n) {
      const double a = (from_deg + (to_deg - from_deg) * n / steps) * std::numbers::pi / 180.0;
      outline.push_back({x + radius * std::cos(a), y + radius * std::sin(a)});
    }
  };
  arc(0.056, 0.004, 0.004, -90, 90, 15);   // the end of the long leg
  arc(0.014, 0.014, 0.006, 270, 180, 15);  // the fillet
  arc(0.004, 0.036, 0.004, 0, 180, 15);    // the end of the short leg
  arc(0.003, 0.003, 0.003, 180, 270, 6);   // the outer corner
  return extruded(outline, {0.005, 0.005}, 0.03);
}

/// 10 mm thick and 30 mm long, with chamfers of 1 mm; its middle is the origin.
inline Part peg() {
  return turned({{0.004, -0.015}, {0.005, -0.014}, {0.005, 0.014}, {0.004, 0.015}}, -0.015, 0.015,
                24);
}

/// 20 teeth, 40 mm across, 10 mm thick.
inline Part gear() {
  constexpr int kTeeth = 20, kSteps = 12;
  std::vector<std::array<double, 2>> outline;
  for (int n = 0; n < kTeeth * kSteps; ++n) {
    const double a = 2.0 * std::numbers::pi * n / (kTeeth * kSteps), wave = std::sin(kTeeth * a);
    const double radius = 0.018 + 0.002 * std::tanh(2.5 * wave);
    outline.push_back({radius * std::cos(a), radius * std::sin(a)});
  }
  return extruded(outline, {0, 0}, 0.01);
}

/// A ribbed knob of about `triangles`, 40 mm across.
inline Part knob(std::uint32_t triangles) {
  const auto around = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
  std::vector<std::array<double, 2>> profile;
  for (std::uint32_t n = 1; n < around; ++n) {
    const double a = std::numbers::pi * n / around;
    profile.push_back({(0.02 + 0.0005 * std::sin(24.0 * a)) * std::sin(a), -0.02 * std::cos(a)});
  }
  return turned(profile, -0.02, 0.02, around);
}

inline void write_obj(const Part& part, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(9);
  for (const Vec3& v : part.vertices)
    out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : part.triangles)
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

}  // namespace voxtouch::test

#pragma once
/// Lengths of a part that a first scene follows from. Loading only: allocates.
#include <optional>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::scene_proposal {

/// A unit that files without one are written in.
struct Unit {
  const char* name;
  double metres;
};
inline constexpr Unit kMillimetre{"mm", 0.001}, kMetre{"m", 1.0};

/// Millimetres or metres: the unit in which the part's largest extent is nearer (by ratio) to the
/// 0.15 m reach of a desk device. From 4.7 on it is mm.
Unit likely_unit(double largest_extent) noexcept;

/// The thickness [m] below which a tenth of the surface is: from points spread uniformly over the
/// area, straight inward to the other side. Empty if no ray meets another side (an open mesh). The
/// time is proportional to points times triangles, limited to 5e7.
std::optional<double> wall_thickness_m(const mesh::TriangleMesh& mesh);

/// First contact of a tool that moves down along -z over the middle of the part's box; over a hole,
/// the highest vertex.
Vec3 place_to_touch(const mesh::TriangleMesh& mesh);

}  // namespace voxtouch::scene_proposal

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

/// Millimetres or metres: the one in which the part's largest extent, in the file's numbers, comes
/// nearer (by ratio) to the 0.15 m that a desk device reaches. From 4.7 on that is mm.
Unit likely_unit(double largest_extent) noexcept;

/// The thickness [m] that a tenth of the surface is thinner than: from points spread evenly over
/// the area, straight inward to the other side. Nothing where no such way meets another side (an
/// open mesh). Time goes with points times triangles, which is bounded (5e7).
std::optional<double> wall_thickness_m(const mesh::TriangleMesh& mesh);

/// Where a tool that comes down along -z over the middle of the part's box meets it first; over a
/// hole there, the highest vertex.
Vec3 place_to_touch(const mesh::TriangleMesh& mesh);

}  // namespace voxtouch::scene_proposal

#pragma once
/// Closed-form meshes for tests of the virtual tool on triangles. Lengths in metres; outward by
/// default.
#include <cmath>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::test {

using Outline = std::vector<Eigen::Vector2d>;  ///< counter-clockwise, seen whole from the origin

/// Axis-aligned box.
mesh::TriangleMesh box(const Vec3& low, const Vec3& high);
/// A subdivided icosahedron: 42, 162, 642, 2562, 10242 vertices for 1 to 5 levels.
mesh::TriangleMesh ball(double radius, int levels);
/// Open square in z = 0 of n x n cells, normals +z; with `t_junctions` a T-junction at each odd
/// cell.
mesh::TriangleMesh sheet(double side, int n, bool t_junctions = false);
/// `outline` from z0 to z1, closed.
mesh::TriangleMesh prism(const Outline& outline, double z0, double z1);
/// A round block of `radius` with a hole of `outline` through it, closed.
mesh::TriangleMesh block_with_hole(const Outline& outline, double radius, double z0, double z1);
/// Closed wedge with the y axis from -half to half as sharp edge, pointing to +z, with the given
/// angle [rad].
mesh::TriangleMesh wedge(double angle, double depth, double half);
/// Closed bowl: half a hollow ball of `inner` and `outer` radius, open to +z, centre at the origin;
/// n x m facets.
mesh::TriangleMesh bowl(double inner, double outer, int around, int down);
/// An M20 bolt along z, closed: ISO thread of `sides` facets a turn whose rows follow the helix.
/// `length` is a multiple of the pitch, 2.5 mm.
mesh::TriangleMesh bolt(double length, int sides);
/// Its nut, a round one: the bolt's thread moved out by `gap`.
mesh::TriangleMesh nut(double length, double gap, int sides);
/// Bumpy ground of n x n cells, open, z up.
mesh::TriangleMesh terrain(double side, int n, double height);

Outline circle(double radius, int n);
/// Arms along x and y: from the centre to `length`, of half width `width`; each side moved out by
/// `grow`.
Outline cross(double length, double width, double grow);
/// `teeth` straight teeth between two radii, each side moved out by `grow`.
Outline gear(int teeth, double root, double tip, double grow);
/// Each side moved outward by `grow`.
Outline grown(const Outline& outline, double grow);

/// All vertices moved by `pose`.
mesh::TriangleMesh moved(const mesh::TriangleMesh& mesh, const Pose& pose);
mesh::TriangleMesh joined(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b);
mesh::TriangleMesh turned_inside_out(mesh::TriangleMesh mesh);

}  // namespace voxtouch::test

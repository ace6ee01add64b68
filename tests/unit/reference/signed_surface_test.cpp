/// Signed distances by the nearest feature against FCL's distances with signs by the winding
/// number, on whatever may fool a normal.
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "core/reference/mesh_distance.hpp"
#include "core/reference/signed_surface.hpp"
#include "tests/support/parts.hpp"

namespace voxtouch::reference {
namespace {

using test::Part;

ReferenceMesh mesh_of(const Part& part) {
  return make_reference_mesh(part.vertices, part.triangles, "part");
}

void append(Part& all, Part more, const Vec3& shift, bool inside_out = false) {
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  for (const Vec3& v : more.vertices)
    all.vertices.push_back(v + shift);
  for (auto t : more.triangles) {
    if (inside_out)
      std::swap(t[1], t[2]);
    all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

Part box(double size) {
  return test::extruded({{0, 0}, {size, 0}, {size, size}, {0, size}}, {0.5 * size, 0.5 * size},
                        size);
}

/// Points around the part, and points next to its corners and edges, where features change.
std::vector<Vec3> places(const ReferenceMesh& mesh, int count) {
  std::mt19937_64 random(3);
  const auto fraction = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices)
    low = low.cwiseMin(v), high = high.cwiseMax(v);
  const Vec3 size = high - low;
  std::vector<Vec3> out;
  for (int n = 0; n < count; ++n) {
    const Vec3 dice(fraction(), fraction(), fraction());
    out.push_back(low - 0.2 * size + 1.4 * size.cwiseProduct(dice));
    const std::size_t t = random() % mesh.triangles.size();
    const double along = n % 2 == 0 ? 0.0 : fraction();
    out.push_back(mesh.corner(t, 0) + along * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
                  0.01 * size.norm() * (dice - Vec3::Constant(0.5)));
  }
  return out;
}

void expect_as_fcl(const ReferenceMesh& mesh, int count) {
  const SignedSurface surface(mesh);
  const MeshDistance distance(mesh);
  const InsideTest inside(mesh);
  std::uint32_t hint = SignedSurface::kNoHint;
  for (const Vec3& x : places(mesh, count)) {
    const double far = distance.nearest(x).distance_m, got = surface.distance(x, hint);
    EXPECT_NEAR(std::abs(got), far, 1e-9 * (1.0 + far)) << x.transpose();
    std::uint32_t none = SignedSurface::kNoHint;
    EXPECT_NEAR(got, surface.distance(x, none), 1e-15) << "the hint changes what it gives";
    if (far > 1e-9) {
      EXPECT_EQ(got < 0.0, inside.inside(x)) << x.transpose();
    }
  }
}

TEST(SignedSurface, IsFclsDistanceWithTheWindingNumbersSign) {
  for (const Part& part : {test::bracket(), test::peg(), test::gear(), box(0.02)}) {
    const ReferenceMesh mesh = mesh_of(part);
    ASSERT_TRUE(mesh.closed);
    EXPECT_TRUE(SignedSurface(mesh).sign_by_feature());
    expect_as_fcl(mesh, 200);
  }
}

TEST(SignedSurface, DetectsInvertedMeshesAndCavities) {
  Part turned_over;
  append(turned_over, test::bracket(), Vec3::Zero(), true);
  EXPECT_TRUE(SignedSurface(mesh_of(turned_over)).sign_by_feature());
  expect_as_fcl(mesh_of(turned_over), 100);
  Part hollow = box(0.04);
  append(hollow, box(0.02), Vec3::Constant(0.01), true);
  EXPECT_TRUE(SignedSurface(mesh_of(hollow)).sign_by_feature());
  expect_as_fcl(mesh_of(hollow), 100);
}

/// Each of them has a normal that lies: an inner wall, a wall twice, a cavity that is none, a
/// corner or an edge shared by two bodies.
TEST(SignedSurface, UsesWindingNumbersForSelfIntersections) {
  const auto two = [](const Vec3& shift, double size = 0.02, bool inside_out = false) {
    Part both = box(0.02);
    append(both, box(size), shift, inside_out);
    return mesh_of(both);
  };
  for (const ReferenceMesh& mesh :
       {two({0.011, 0.012, 0.013}), two({0.02, 0, 0}), two({0.005, 0.005, 0.02}, 0.01),
        two({0.005, 0.006, 0.007}, 0.01), two({0.02, 0.02, 0.02}), two({0.02, 0.02, 0.0}),
        two({0.03, 0, 0}, 0.02, true)}) {
    ASSERT_TRUE(mesh.closed);
    EXPECT_FALSE(SignedSurface(mesh).sign_by_feature());
    expect_as_fcl(mesh, 100);
  }
}

TEST(SignedSurface, RefusesAnOpenMesh) {
  ReferenceMesh mesh = mesh_of(box(0.02));
  mesh.triangles.pop_back(), mesh.closed = false;
  EXPECT_THROW(SignedSurface surface(mesh), std::invalid_argument);
}

}  // namespace
}  // namespace voxtouch::reference

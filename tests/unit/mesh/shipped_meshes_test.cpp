/// The meshes of deploy/meshes: assumptions of their scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/mesh/import.hpp"
#include "samples.hpp"

using namespace voxtouch;

namespace {

const std::filesystem::path kMeshes = std::filesystem::path(VOXTOUCH_DEPLOY) / "meshes";

struct Shipped {
  const char* name;
  double scale;
  long euler;
  double volume_m3, volume_error;
};
void PrintTo(const Shipped& s, std::ostream* out) { *out << s.name; }

class EveryShippedMesh : public ::testing::TestWithParam<Shipped> {};

TEST_P(EveryShippedMesh, IsOneClosedSurfaceFacingOutward) {
  const Shipped& s = GetParam();
  const mesh::ImportedMesh got =
      mesh::import_mesh(kMeshes / s.name, {.scale = s.scale, .voxel_size_m = 0.002});
  EXPECT_TRUE(got.report.clean()) << got.report.sentences().front();
  EXPECT_TRUE(got.warnings.empty() || std::string(s.name) == "sphere.obj") << got.warnings.front();
  EXPECT_TRUE(got.report.closed);
  EXPECT_EQ(got.report.parts, 1u);
  // Of a mesh without a finding; 2 a closed part, less 2 for each handle.
  EXPECT_EQ(static_cast<long>(got.report.points + got.report.triangles) -
                static_cast<long>(got.report.edges),
            s.euler);
  EXPECT_NEAR(got.report.signed_volume_m3 / s.volume_m3, 1.0, s.volume_error);
}

const double kSlab = 0.24 * 0.24 * 0.02, kBall = 4.0 / 3.0 * M_PI;
// Of the cup without its handle, with square edges: pi (R^2 h - r^2 (h - bottom)).
const double kCup = M_PI * (0.04 * 0.04 * 0.09 - 0.035 * 0.035 * 0.084);
INSTANTIATE_TEST_SUITE_P(ShippedMeshes, EveryShippedMesh,
                         ::testing::Values(Shipped{"block.obj", 1, 2, 4.8e-5, 1e-6},
                                           Shipped{"plane.obj", 1, 2, kSlab, 1e-6},
                                           Shipped{"tilted_plane.obj", 1, 2, kSlab, 1e-6},
                                           Shipped{"cylinder.obj", 1, 2, M_PI * 0.04 * 0.04 * 0.2,
                                                   1e-3},
                                           Shipped{"sphere.obj", 1, 2, kBall, 0.01},
                                           Shipped{"sphere_mm.stl", 1e-3, 2, kBall * 1e-6, 0.01},
                                           Shipped{"cup.obj", 1, 0, kCup, 0.08},
                                           Shipped{"cup_mm.stl", 1e-3, 0, kCup, 0.08}));

TEST(ShippedMeshes, AreWhatTheirScriptWrites) {
  const std::string command =
      "python3 -B '" + (kMeshes / "../../tests/unit/mesh/make_meshes.py").string() + "' --check";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(ShippedMeshes, LieAtTheirScenesPositions) {
  const mesh::MeshReport plane = mesh::import_mesh(kMeshes / "plane.obj").report;
  EXPECT_EQ(plane.max.z(), 0.0);
  EXPECT_NEAR(plane.min.z(), -0.02, 1e-8);
  EXPECT_NEAR(plane.max.x(), 0.12, 1e-8);
  const mesh::MeshReport cylinder = mesh::import_mesh(kMeshes / "cylinder.obj").report;
  EXPECT_NEAR((cylinder.max - Vec3(0.04, 0.1, 0.04)).norm(), 0.0, 1e-8);
  EXPECT_NEAR((cylinder.min + Vec3(0.04, 0.1, 0.04)).norm(), 0.0, 1e-8);
  const mesh::MeshReport cup = mesh::import_mesh(kMeshes / "cup.obj").report;
  EXPECT_EQ(cup.min.z(), 0.0);
  EXPECT_NEAR(cup.max.z(), 0.09, 1e-6);
  EXPECT_NEAR(cup.max.y(), 0.04, 1e-4);
  EXPECT_GT(cup.max.x(), 0.065);
}

TEST(ShippedMeshes, TiltedPlaneFollowsNoAxis) {
  const mesh::TriangleMesh mesh = mesh::import_mesh(kMeshes / "tilted_plane.obj").mesh;
  const double a = 20 * M_PI / 180, b = 25 * M_PI / 180;
  const Mat3 turn = (Eigen::AngleAxisd(b, Vec3::UnitY()) * Eigen::AngleAxisd(a, Vec3::UnitX()))
                        .toRotationMatrix();
  const mesh::TriangleMesh flat = mesh::import_mesh(kMeshes / "plane.obj").mesh;
  for (std::size_t v = 0; v < 8; ++v)
    EXPECT_LT((turn * flat.vertices[v] - mesh.vertices[v]).norm(), 2e-8);
}

TEST(ShippedMeshes, SphereCornersLieOnTheSphere) {
  for (const Vec3& v : mesh::import_mesh(kMeshes / "sphere.obj").mesh.vertices)
    EXPECT_NEAR(v.norm(), 1.0, 1e-7);
}

TEST(ShippedMeshes, BothCupsAreOne) {
  const mesh::TriangleMesh metres = mesh::import_mesh(kMeshes / "cup.obj").mesh;
  const mesh::TriangleMesh millimetres =
      mesh::import_mesh(kMeshes / "cup_mm.stl", {.scale = 0.001}).mesh;
  ASSERT_EQ(metres.triangles.size(), millimetres.triangles.size());
  for (std::size_t t = 0; t < metres.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((metres.corner(t, k) - millimetres.corner(t, k)).norm(), 2e-8) << t;
  }
}

/// Does the segment p-q go through triangle t (borders included, within rounding)?
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double dp = n.dot(p - a), dq = n.dot(q - a);
  if ((dp > 0) == (dq > 0))
    return false;
  const Vec3 x = p + (q - p) * (dp / (dp - dq));
  return n.dot((b - a).cross(x - a)) >= 0 && n.dot((c - b).cross(x - b)) >= 0 &&
         n.dot((a - c).cross(x - c)) >= 0;
}

bool have_common_corner(const std::array<std::uint32_t, 3>& s,
                        const std::array<std::uint32_t, 3>& t) {
  for (const auto i : s) {
    if (i == t[0] || i == t[1] || i == t[2])
      return true;
  }
  return false;
}

/// Pairs without a common corner: no side of one passes through the other. Neighbours: not folded
/// onto each other.
std::size_t self_intersections(const mesh::TriangleMesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes(mesh.triangles.size());
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      boxes[t].extend(mesh.corner(t, k));
    normals.push_back((mesh.corner(t, 1) - mesh.corner(t, 0))
                          .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                          .normalized());
  }
  std::size_t count = 0;
  for (std::size_t s = 0; s < boxes.size(); ++s) {
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      if (s == t || !boxes[s].intersects(boxes[t]))
        continue;
      if (have_common_corner(mesh.triangles[s], mesh.triangles[t])) {
        int common = 0;
        for (const auto i : mesh.triangles[s]) {
          common += std::count(mesh.triangles[t].begin(), mesh.triangles[t].end(), i) > 0;
        }
        count += common == 2 && normals[s].dot(normals[t]) < -0.5;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        count += pierces(mesh.corner(s, k), mesh.corner(s, (k + 1) % 3), mesh.corner(t, 0),
                         mesh.corner(t, 1), mesh.corner(t, 2));
      }
    }
  }
  return count;
}

TEST(ShippedMeshes, CupHasNoSelfIntersection) {
  EXPECT_EQ(self_intersections(mesh::import_mesh(kMeshes / "cup.obj").mesh), 0u);
}

TEST(ShippedMeshes, TheTestForSelfIntersectionsFindsThem) {
  EXPECT_GT(self_intersections(samples::joined(samples::box({0, 0, 0}, {1, 1, 1}),
                                               samples::box({0.4, 0.45, 0.5}, {2, 2, 2}))),
            0u);
}

/// The path of the hand: a finger's width of air between wall and handle, surrounded by solid.
TEST(ShippedMeshes, CupHasAHandleWithRoomForAFinger) {
  const mesh::TriangleMesh cup = mesh::import_mesh(kMeshes / "cup.obj").mesh;
  const auto crossings = [&](const Vec3& from, const Vec3& to) {
    int count = 0;
    for (std::size_t t = 0; t < cup.triangles.size(); ++t) {
      count += pierces(from, to, cup.corner(t, 0), cup.corner(t, 1), cup.corner(t, 2));
    }
    return count;
  };
  const double z = 0.0453;
  for (const double x : {0.043, 0.050, 0.058})
    EXPECT_EQ(crossings({x, -0.1, z}, {x, 0.1003, z}), 0) << x;
  EXPECT_EQ(crossings({0.0655, -0.1, z}, {0.0655, 0.1003, z}), 2);  // through the handle
  EXPECT_EQ(crossings({-0.1, 0.0007, z}, {0.1, 0.0009, z}), 6);     // two walls and the handle
  EXPECT_EQ(crossings({0.0101, 0.0007, -0.1}, {0.0103, 0.0009, 0.2}), 2);  // the bottom, open above
}

}  // namespace

/// Results of the import, compared with independent readers in this file.
#include "core/mesh/import.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "samples.hpp"

using namespace voxtouch;
using samples::Folder;

namespace {

const std::filesystem::path kVectors = std::filesystem::path(VOXTOUCH_TEST_DATA) / "vectors/meshes";

/// Lines `v x y z` and `f a b c`, nothing else, with doubles.
mesh::TriangleMesh plain_obj(const std::filesystem::path& path) {
  mesh::TriangleMesh mesh;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 x;
      words >> x.x() >> x.y() >> x.z();
      mesh.vertices.push_back(x);
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> t{};
      words >> t[0] >> t[1] >> t[2];
      mesh.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
    }
  }
  return mesh;
}

void expect_same_triangles(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(a.corner(t, k), b.corner(t, k)) << "triangle " << t << ", corner " << k;
    }
  }
}

class EveryVector : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryVector, ImportsExactlyAndInOrder) {
  const auto path = kVectors / (std::string(GetParam()) + ".obj");
  mesh::TriangleMesh expected = plain_obj(path);
  ASSERT_FALSE(expected.empty());
  const std::size_t collapsed = std::erase_if(expected.triangles, [&](const auto& t) {
    const auto at = [&](int k) { return expected.vertices[t[k]]; };
    return at(0) == at(1) || at(1) == at(2) || at(2) == at(0);
  });
  const mesh::ImportedMesh got = mesh::import_mesh(path, {.voxel_size_m = 0.125});
  expect_same_triangles(got.mesh, expected);
  EXPECT_TRUE(got.report.closed);
  EXPECT_FALSE(got.report.inverted);
  EXPECT_EQ(got.warnings.size(), collapsed > 0 ? 1u : 0u);
}

INSTANTIATE_TEST_SUITE_P(Import, EveryVector,
                         ::testing::Values("sphere", "slab_tilted", "cylinder", "lshape",
                                           "aligned_box", "degenerate_tris"));

TEST(Import, ReadsTheSameSphereFromStlAsFromObj) {
  const mesh::ImportedMesh stl = mesh::import_mesh(kVectors / "sphere.stl"),
                           obj = mesh::import_mesh(kVectors / "sphere.obj");
  expect_same_triangles(stl.mesh, obj.mesh);
  EXPECT_EQ(stl.mesh.vertices.size(), 258u);
  EXPECT_NEAR(stl.report.signed_volume_m3, 1.7261676908625911, 1e-12);
}

TEST(Import, KeepsCollinearTrianglesAndSkipsCollapsedOnes) {
  const mesh::ImportedMesh got = mesh::import_mesh(kVectors / "degenerate_tris.obj");
  EXPECT_EQ(got.mesh.triangles.size(), 5u);
  EXPECT_EQ(got.report.zero_area.examples, (std::vector<std::uint32_t>{4}));
  ASSERT_EQ(got.warnings.size(), 1u);
  EXPECT_TRUE(got.warnings[0].starts_with("2 triangles with two equal corners")) << got.warnings[0];
  EXPECT_LT(got.report.max.maxCoeff(), 1.0);  // the unused vertex at (3, 3, 3) does not count
}

TEST(Import, KeepsFileOrderAcrossGroupsObjectsAndMaterials) {
  const Folder folder;
  const auto path = folder.write(
      "order.obj",
      "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no A\nusemtl x\nf 1 3 2\n"
      "g B extra\nusemtl y\nf 1 2 4\no A\n usemtl x\ns 1\nf 1 4 3\ng B \\\nextra\nf 2 3 4\n");
  expect_same_triangles(mesh::import_mesh(path).mesh, samples::tetrahedron());
  // Back to an object that was there before: assimp alone gives triangle 2 before triangle 1.
  const auto back = folder.write(
      "back.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no A\nusemtl x\nf 1 3 2\no B\nusemtl y\nf 1 2 4\n"
      "o A\nusemtl x\nf 1 4 3\no B\nf 2 3 4\n");
  expect_same_triangles(mesh::import_mesh(back).mesh, samples::tetrahedron());
}

TEST(Import, CutsPolygonsInPlace) {
  const Folder folder;
  const auto path = folder.write(
      "quads.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvn 0 0 1\n"
      "f 1/1/1 4/1/1 3/1/1 2/1/1\nf 5 6 7 8\nf 1 2 6 5\nf 2//1 3//1 7//1 6//1\nf -6 -5 -1 -2\n"
      "f 4 1 5 8\n");
  const mesh::ImportedMesh got = mesh::import_mesh(path);
  EXPECT_EQ(got.mesh.triangles.size(), 12u);
  EXPECT_TRUE(got.report.clean());
  EXPECT_NEAR(got.report.signed_volume_m3, 1.0, 1e-15);
  for (int t = 0; t < 2; ++t)
    EXPECT_EQ(got.mesh.corner(static_cast<std::size_t>(t), 0).z(), 0.0);
  for (int t = 2; t < 4; ++t)
    EXPECT_EQ(got.mesh.corner(static_cast<std::size_t>(t), 0).z(), 1.0);
}

TEST(Import, CutsAPolygonOfManyCorners) {
  const Folder folder;
  constexpr int kCorners = 3000;
  std::string vertices, face = "f";
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kCorners;
    vertices +=
        "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
    face += " " + std::to_string(k + 1);
  }
  const mesh::ImportedMesh got =
      mesh::import_mesh(folder.write("disc.obj", vertices + face + "\n"));
  double area = 0.0;
  for (std::size_t t = 0; t < got.mesh.triangles.size(); ++t) {
    const Vec3 a = got.mesh.corner(t, 0);
    area += 0.5 * (got.mesh.corner(t, 1) - a).cross(got.mesh.corner(t, 2) - a).z();
  }
  EXPECT_NEAR(area, std::numbers::pi, 1e-4);
}

TEST(Import, LeavesLinesAndPointsOutWithAWarning) {
  const Folder folder;
  const auto path =
      folder.write("lines.obj", samples::obj_text(samples::tetrahedron()) + "l 1 2\nl 2 3\np 4\n");
  const mesh::ImportedMesh got = mesh::import_mesh(path);
  EXPECT_EQ(got.mesh.triangles.size(), 4u);
  ASSERT_EQ(got.warnings.size(), 2u);
  EXPECT_NE(got.warnings[0].find("1 point "), std::string::npos);
  EXPECT_NE(got.warnings[1].find("2 lines "), std::string::npos);
}

TEST(Import, ScalesAndPosesInDouble) {
  const Folder folder;
  const auto path = folder.write("t.obj", samples::obj_text(samples::tetrahedron()));
  const Pose pose{{1e6, 0, 0}, Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()))};
  const mesh::ImportedMesh got =
      mesh::import_mesh(path, {.scale = 1e-3, .pose = pose, .voxel_size_m = 1e-4});
  EXPECT_LT((got.mesh.corner(0, 1) - Vec3(1e6 - 1e-3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((got.mesh.corner(0, 2) - Vec3(1e6, 1e-3, 0)).norm(), 1e-9);
}

TEST(Import, GuessesMillimetresForHugeMeshes) {
  const Folder folder;
  const auto path =
      folder.write("t.stl", samples::binary_stl(samples::box({0, 0, 0}, {80, 80, 90})));
  const mesh::ImportedMesh got = mesh::import_mesh(path, {.voxel_size_m = 0.002});
  ASSERT_EQ(got.warnings.size(), 1u);
  for (const char* part :
       {"90 m", "0.002 m", "45000 voxels", "millimetres", "0.001", ".stl has no unit"}) {
    EXPECT_NE(got.warnings[0].find(part), std::string::npos) << part << " in " << got.warnings[0];
  }
  EXPECT_TRUE(mesh::import_mesh(path, {.scale = 0.001, .voxel_size_m = 0.002}).warnings.empty());
}

TEST(Import, WarnsIfTheMeshIsSmallerThanItsVoxels) {
  const Folder folder;
  const auto path =
      folder.write("t.stl", samples::binary_stl(samples::box({0, 0, 0}, {0.08, 0.08, 0.09})));
  const mesh::ImportedMesh small = mesh::import_mesh(path, {.scale = 0.001, .voxel_size_m = 0.002});
  ASSERT_EQ(small.warnings.size(), 1u);
  EXPECT_NE(small.warnings[0].find("millimetres"), std::string::npos) << small.warnings[0];
  const mesh::ImportedMesh coarse = mesh::import_mesh(path, {.voxel_size_m = 0.03});
  ASSERT_EQ(coarse.warnings.size(), 1u);
  EXPECT_NE(coarse.warnings[0].find("only 3 voxels"), std::string::npos) << coarse.warnings[0];
  EXPECT_TRUE(mesh::import_mesh(path).warnings.empty());
}

TEST(Import, RepeatsBitIdentically) {
  const auto path = kVectors / "lshape.obj";
  const mesh::ImportedMesh a = mesh::import_mesh(path, {.scale = 0.37}),
                           b = mesh::import_mesh(path, {.scale = 0.37});
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}

}  // namespace

/// The reference's triangulation of a polygon.
#include "core/reference/ear_clipping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "core/reference/inside_test.hpp"
#include "core/reference/plain_mesh_files.hpp"
#include "core/reference/reference_mesh.hpp"
#include "test_scenes.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::reference {
namespace {

using Corners = std::vector<Vec3>;

Vec3 doubled_area(const Corners& path) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < path.size(); ++k)
    sum += (path[k] - path[0]).cross(path[k + 1] - path[0]);
  return sum;
}

void expect_clipped(const Corners& polygon, std::size_t triangles) {
  const auto clipped = clip_ears(polygon);
  ASSERT_EQ(clipped.size(), triangles);
  const Vec3 area = doubled_area(polygon);
  double sum = 0;
  for (const auto& t : clipped) {
    const double part =
        doubled_area({polygon[t[0]], polygon[t[1]], polygon[t[2]]}).dot(area.normalized());
    EXPECT_GT(part, -1e-12);
    sum += std::abs(part);
  }
  EXPECT_NEAR(sum, area.norm(), 1e-9 * area.norm());
}

TEST(EarClipping, CutsRandomStarsWithCornersOnTheirEdges) {
  std::mt19937 random(static_cast<unsigned>(voxtouch::testing::seed(3)));
  std::uniform_real_distribution<double> radius(0.1, 1.0);
  for (int round = 0; round < 500; ++round) {
    const std::size_t n = 4 + random() % 20;
    Corners path;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      const double r = radius(random);
      path.emplace_back(round % 3, r * std::cos(angle), r * std::sin(angle));
    }
    Corners more;
    for (std::size_t k = 0; k < n; ++k) {
      more.push_back(path[k]);
      if (round % 2 == 0)
        more.push_back(0.5 * (path[k] + path[(k + 1) % n]));
    }
    expect_clipped(more, more.size() - 2);
    std::ranges::reverse(more);
    expect_clipped(more, more.size() - 2);
    if (HasFailure())
      FAIL() << "round " << round;
  }
}

TEST(EarClipping, KeepsAHoleThatABridgeJoins) {
  expect_clipped({{0, 0, 0},
                  {4, 0, 0},
                  {4, 4, 0},
                  {0, 4, 0},
                  {0, 0, 0},
                  {1, 1, 0},
                  {1, 3, 0},
                  {3, 3, 0},
                  {3, 1, 0},
                  {1, 1, 0}},
                 8);
}

TEST(EarClipping, RefusesAPolygonThatCrossesItself) {
  EXPECT_THROW(clip_ears(Corners{{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}}), std::runtime_error);
}

TEST(EarClipping, GivesAMeshOfPolygonsItsSolid) {
  // An L with one hexagon as each of its end faces, from each of their corners.
  for (int first = 0; first < 6; ++first) {
    std::string text;
    for (const char* y : {" 0 ", " 30 "}) {
      for (const auto& [x, z] : {std::pair("0", "0"),
                                 {"40", "0"},
                                 {"40", "10"},
                                 {"20", "10"},
                                 {"20", "20"},
                                 {"0", "20"}}) {
        text += std::string("v ") + x + y + z + "\n";
      }
    }
    std::string front = "f", back = "f";
    for (int k = 0; k < 6; ++k) {
      front += " " + std::to_string((first + k) % 6 + 1);
      back += " " + std::to_string(12 - (first + k) % 6);
    }
    text += front + "\n" + back + "\n";
    for (int k = 0; k < 6; ++k) {
      const int n = (k + 1) % 6;
      for (const int corner : {k + 1, k + 7, n + 7, n + 1})
        text += (corner == k + 1 ? "f " : " ") + std::to_string(corner);
      text += "\n";
    }
    const test_scenes::TemporaryMesh file("voxtouch_reference_l.obj", text);
    const ReferenceMesh mesh = read_reference_mesh(file.spec());
    EXPECT_TRUE(mesh.closed) << first;
    EXPECT_EQ(mesh.triangles.size(), 20U);
    double area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      area += 0.5 * doubled_area({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}).norm();
    }
    EXPECT_NEAR(area, 2 * 600.0 + 30.0 * 120.0, 1e-9)
        << "a flap outside of the L, turned from corner " << first;
    const InsideTest inside(mesh);
    EXPECT_TRUE(inside.inside({10, 15, 15}));
    EXPECT_FALSE(inside.inside({30, 15, 15}));
  }
}

constexpr const char* kSheet =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 "
    "0\nendloop\nendfacet\nendsolid a\n";

void expect_corner(const PlainFile& file) {
  ASSERT_EQ(file.vertices.size(), 3U);
  EXPECT_EQ(file.vertices[1], Vec3(1, 0, 0));
  EXPECT_EQ(file.vertices[2], Vec3(0, 1, 0));
  EXPECT_EQ(file.faces, (std::vector<std::vector<std::uint32_t>>{{0, 1, 2}}));
}

TEST(PlainMeshFiles, AreReadInAnyTextLayout) {
  const std::string mark = "\xef\xbb\xbf", stl = kSheet;
  std::string upper = stl;
  for (char& c : upper)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_corner(read_stl(stl));
  expect_corner(read_stl(mark + stl));
  expect_corner(read_stl(upper));
  expect_corner(read_obj(mark + "v 0 0 0\nv 1 0 0 1\nv 0 2 0 2\nf 1/1/1 2//2 -1\nl 1 2\n"));
  expect_corner(read_obj("o a\rV 0 0 0\rv +1 0 0 \rv 0 1 0 .5 .5 .5\rf 1 \\\r\n 2 3\r"));
  std::string binary(80, ' ');
  const std::uint32_t one = 1;
  binary.append(reinterpret_cast<const char*>(&one), sizeof one);
  for (const float x : {9.f, 9.f, 9.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    binary.append(reinterpret_cast<const char*>(&x), sizeof x);
  expect_corner(read_stl(binary + std::string(2 + 92, '\0')));
  EXPECT_THROW(read_stl(binary), std::runtime_error);
  EXPECT_THROW(read_obj("v 0 0 0\nf 1 2 3\n"), std::runtime_error);
  EXPECT_THROW(read_obj("v 0 0\n"), std::runtime_error);
}

TEST(ReferenceMesh, FindsFilesInPercentCodeAndSkipsAByteOrderMark) {
  const test_scenes::TemporaryMesh ply(
      "voxtouch_reference_mark.ply",
      "\xef\xbb\xbfply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float "
      "y\nproperty float "
      "z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
      "0\n0 0 1\n3 0 2 "
      "1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_EQ(read_reference_mesh(ply.spec()).triangles.size(), 4U);
  std::string buffer;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    buffer.append(reinterpret_cast<const char*>(&x), sizeof x);
  const test_scenes::TemporaryMesh bin("voxtouch reference.bin", buffer);
  const test_scenes::TemporaryMesh gltf(
      "voxtouch_reference.gltf",
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"voxtouch%20reference.bin"}],
"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})");
  EXPECT_EQ(read_reference_mesh(gltf.spec()).triangles.size(), 1U);
}

}  // namespace
}  // namespace voxtouch::reference

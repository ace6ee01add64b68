/// The reference's reader, its inside test and FCL's distances, each compared with a simpler
/// method.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/reference/inside_test.hpp"
#include "core/reference/mesh_distance.hpp"
#include "core/reference/reference_mesh.hpp"
#include "test_scenes.hpp"
#include "tests/support/exact_shapes/shapes.hpp"

namespace voxtouch::reference {
namespace {

using namespace test_scenes;

/// Distance to a triangle by the direct method: to its plane if the foot is inside, otherwise to
/// the nearest edge.
double plain_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a).normalized();
  const Vec3 projected = x - n.dot(x - a) * n;
  const auto left = [&](const Vec3& p, const Vec3& q) {
    return n.dot((q - p).cross(projected - p)) >= 0;
  };
  if (left(a, b) && left(b, c) && left(c, a))
    return (x - projected).norm();
  const auto edge = [&](const Vec3& p, const Vec3& q) {
    const double along = std::clamp((x - p).dot(q - p) / (q - p).squaredNorm(), 0.0, 1.0);
    return (x - p - along * (q - p)).norm();
  };
  return std::min({edge(a, b), edge(b, c), edge(c, a)});
}

std::vector<Vec3> points_around(const ReferenceMesh& mesh, int count, unsigned seed) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices)
    low = low.cwiseMin(v), high = high.cwiseMax(v);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.25, 1.25);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(low +
                     (high - low).cwiseProduct(Vec3(unit(random), unit(random), unit(random))));
  return points;
}

TEST(ReferenceMesh, ReadsTheSameSphereFromObjAndStl) {
  const ReferenceMesh obj = read_reference_mesh(mesh("sphere.obj")),
                      stl = read_reference_mesh(mesh("sphere.stl"));
  EXPECT_EQ(obj.triangles.size(), 512U);
  EXPECT_EQ(obj.vertices.size(), 258U);
  EXPECT_EQ(stl.triangles.size(), 512U);
  EXPECT_EQ(stl.vertices.size(), 258U) << "corners at equal positions are one vertex";
  EXPECT_TRUE(obj.closed && stl.closed);
}

TEST(ReferenceMesh, AppliesTheScale) {
  const ReferenceMesh one = read_reference_mesh(mesh("lshape.obj")),
                      two = read_reference_mesh(mesh("lshape.obj", 0.5));
  for (std::size_t v = 0; v < one.vertices.size(); ++v)
    EXPECT_EQ(two.vertices[v], Vec3(0.5 * one.vertices[v]));
}

TEST(ReferenceMesh, AppliesTransformsAndKeepsMirrorsOutward) {
  for (const char* up :
       {"X_UP", "Y_UP", "Z_UP"}) {  // axes are unchanged, as in the reader of the rendering
    const TemporaryMesh file("voxtouch_reference_nodes.dae",
                             R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>)" +
                                 std::string(up) + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="outer"><translate>10 0 0</translate>
<node id="inner"><scale>-2 2 2</scale><instance_geometry url="#g"/></node></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
    const ReferenceMesh found = read_reference_mesh(file.spec());
    ASSERT_EQ(found.triangles.size(), 4U);
    Vec3 low = found.vertices.front(), high = low;
    for (const Vec3& v : found.vertices)
      low = low.cwiseMin(v), high = high.cwiseMax(v);
    EXPECT_EQ(low, Vec3(8, 0, 0)) << up;
    EXPECT_EQ(high, Vec3(10, 2, 2));
    EXPECT_NEAR(InsideTest(found).winding_number(Vec3(9.8, 0.2, 0.2)), 1.0, 1e-12);
  }
}

TEST(ReferenceMesh, DropsWhatHasNoAreaAndWhatIsRepeated) {
  const ReferenceMesh found = read_reference_mesh(mesh("degenerate_tris.obj"));
  EXPECT_EQ(found.triangles.size(), 4U);
  EXPECT_TRUE(found.closed);
  const ReferenceMesh twice = make_reference_mesh({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                                                  {{0, 1, 2}, {1, 2, 0}}, "m");
  EXPECT_EQ(twice.triangles.size(), 1U);
  EXPECT_EQ(twice.dropped, 1U);
}

TEST(ReferenceMesh, JoinsSeamsThatDifferByTheRoundingOfAFile) {
  // A tetrahedron of triangles with separate corners, a few 1e-18 m apart, as exporters of round
  // shapes write poles.
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::array<std::uint32_t, 3> faces[] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& face : faces) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const std::uint32_t corner : face)
      vertices.push_back(corners[corner] +
                         Vec3::Constant(1e-18 * static_cast<double>(vertices.size())));
    triangles.push_back({first, first + 1, first + 2});
  }
  const ReferenceMesh mesh = make_reference_mesh(vertices, triangles, "tetrahedron");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_TRUE(mesh.closed);
}

TEST(ReferenceMesh, DistinguishesOpenFromClosed) {
  ReferenceMesh box = read_reference_mesh(mesh("aligned_box.obj"));
  EXPECT_TRUE(box.closed);
  std::vector<std::array<std::uint32_t, 3>> open = box.triangles;
  open.pop_back();
  EXPECT_FALSE(make_reference_mesh(box.vertices, open, "open").closed);
  std::swap(box.triangles[3][0], box.triangles[3][1]);
  EXPECT_FALSE(make_reference_mesh(box.vertices, box.triangles, "one turned").closed);
}

TEST(ReferenceMesh, RefusesUnreadableFiles) {
  const auto sentence = [](const scene::MeshSpec& spec) -> std::string {
    try {
      read_reference_mesh(spec);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(sentence(mesh("no_such.obj")).find("no_such.obj"), std::string::npos);
  EXPECT_NE(sentence(mesh("sphere.obj", 0.0)).find("scale"), std::string::npos);
  EXPECT_NE(sentence(mesh("sphere.obj", NAN)).find("scale"), std::string::npos);
  EXPECT_THROW(
      make_reference_mesh({Vec3(0, NAN, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}, "m"),
      std::runtime_error);
  EXPECT_THROW(make_reference_mesh({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, {{0, 1, 2}}, "m"),
               std::runtime_error);
}

TEST(InsideTest, EqualsTheExactWindingNumber) {
  for (const char* name : {"sphere.obj", "cylinder.obj", "lshape.obj", "slab_tilted.obj"}) {
    const ReferenceMesh solid = read_reference_mesh(mesh(name));
    const InsideTest test(solid);
    for (const Vec3& x : points_around(solid, 1500, 3)) {
      const double exact = test.winding_number(x);
      EXPECT_NEAR(exact, std::round(exact), 1e-9);
      EXPECT_NEAR(test.winding_estimate(x), exact, 0.05);
      EXPECT_EQ(test.inside(x), exact > 0.5);
    }
  }
}

TEST(InsideTest, EqualsTheClosedFormUpToTheSurface) {
  const InsideTest test(read_reference_mesh(mesh("aligned_box.obj")));
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_TRUE(test.inside(Vec3(0.375 - off, 0.1, 0.05)));
    EXPECT_FALSE(test.inside(Vec3(0.375 + off, 0.1, 0.05)));
    EXPECT_TRUE(test.inside(Vec3(0.375 - off, 0.25 - off, 0.25 - off)));
  }
  EXPECT_FALSE(test.inside(Vec3(NAN, 0, 0)));
}

TEST(InsideTest, IgnoresCracksAndInversion) {
  ReferenceMesh sphere_mesh = read_reference_mesh(mesh("sphere.obj"));
  const Vec3 centre = Vec3(0.0129, -0.021, 0.034);
  for (auto& t : sphere_mesh.triangles)
    std::swap(t[0], t[1]);
  EXPECT_TRUE(InsideTest(sphere_mesh).inside(centre));
  EXPECT_FALSE(InsideTest(sphere_mesh).inside(centre + Vec3(0.76, 0, 0)));
  sphere_mesh.triangles.erase(sphere_mesh.triangles.begin() + 100,
                              sphere_mesh.triangles.begin() + 103);
  EXPECT_TRUE(InsideTest(sphere_mesh).inside(centre));
  EXPECT_FALSE(InsideTest(sphere_mesh).inside(centre + Vec3(0.7, 0.7, 0)));
}

TEST(MeshDistance, BothMethodsEqualBruteForce) {
  for (const char* name : {"sphere.obj", "cylinder.obj", "lshape.obj", "degenerate_tris.obj"}) {
    const ReferenceMesh solid = read_reference_mesh(mesh(name));
    const MeshDistance distance(solid);
    for (const Vec3& x : points_around(solid, 400, 5)) {
      double least = 1e9;
      for (std::size_t t = 0; t < solid.triangles.size(); ++t)
        least = std::min(
            least, plain_distance(x, solid.corner(t, 0), solid.corner(t, 1), solid.corner(t, 2)));
      const NearestPoint found = distance.nearest(x);
      EXPECT_NEAR(found.distance_m, least, 1e-12);
      EXPECT_NEAR((found.point - x).norm(), least, 1e-12);
      EXPECT_NEAR(distance.second_method(x), least, distance.second_method_error_m());
    }
  }
}

TEST(MeshDistance, IsZeroOnTheSurfaceItself) {
  const ReferenceMesh solid = read_reference_mesh(mesh("lshape.obj"));
  const MeshDistance distance(solid);
  for (const Vec3& corner : solid.vertices)
    EXPECT_NEAR(distance.nearest(corner).distance_m, 0.0, 1e-8);
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    EXPECT_NEAR(distance.nearest((solid.corner(t, 0) + solid.corner(t, 1)) / 2).distance_m, 0.0,
                1e-8);
}

/// FCL compares squared areas with an absolute threshold: in metres it took small triangles that
/// are apart for ones that meet.
TEST(MeshDistance, OfSmallTrianglesIsTheirGap) {
  for (const double edge : {1e-3, 1e-4, 1e-5}) {
    const mesh::TriangleMesh box = test::box(Vec3::Zero(), Vec3::Constant(edge));
    const ReferenceMesh solid = make_reference_mesh(box.vertices, box.triangles, "box");
    const MeshDistance one(solid), other(solid);
    const Pose apart{{0.2 * edge, 0.3 * edge, 1.1 * edge},
                     Quat(Eigen::AngleAxisd(0.01, Vec3(0, 0, 1)))};
    const NearestPair found = one.to(other, apart);
    EXPECT_NEAR(found.distance_m, 0.1 * edge, 1e-9 * edge) << edge;
    EXPECT_NEAR((found.mine - found.other).norm(), 0.1 * edge, 1e-9 * edge) << edge;
  }
}

TEST(MeshDistance, OfTwoBoxesIsTheirGap) {
  const MeshDistance one(read_reference_mesh(mesh("aligned_box.obj"))),
      two(read_reference_mesh(mesh("aligned_box.obj")));
  const NearestPair apart = one.to(two, at(Vec3(1.0, 0.1, 0.0)));
  EXPECT_NEAR(apart.distance_m, 0.25, 1e-12);
  EXPECT_NEAR(apart.mine.x(), 0.375, 1e-12);
  EXPECT_NEAR(apart.other.x(), 0.625, 1e-12);
  EXPECT_EQ(one.to(two, at(Vec3(0.6, 0.1, 0.05))).distance_m, 0.0);
}

}  // namespace
}  // namespace voxtouch::reference

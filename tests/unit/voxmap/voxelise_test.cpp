#include "core/voxmap/voxelise.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "tests/support/voxel_report.hpp"
#include "tests/unit/voxmap/vectors.hpp"

namespace voxtouch::voxmap {
namespace {

using namespace test;

struct Voxels {
  std::vector<VoxelIndex> surface, interior;
  VoxelReport report;
  bool operator==(const Voxels& other) const {
    return surface == other.surface && interior == other.interior;
  }
};

Voxels voxels(const mesh::TriangleMesh& mesh, const Grid& grid,
              const ParallelFor& loop = serial_for()) {
  Voxels out;
  const Voxmap map = voxelise(mesh, grid, loop);
  out.report = voxel_report(mesh, grid);
  out.surface = voxels_of(map, VoxelKind::kSurface);
  out.interior = voxels_of(map, VoxelKind::kInterior);
  EXPECT_EQ(map.surface_count(), out.surface.size());
  EXPECT_EQ(map.interior_count(), out.interior.size());
  return out;
}

/// Voxels that a walk over faces reaches from outside without crossing surface must not be
/// interior: no hole.
bool has_hole(const Voxels& v) {
  const std::set<VoxelIndex> interior(v.interior.begin(), v.interior.end()),
      surface(v.surface.begin(), v.surface.end());
  for (const VoxelIndex& at : v.interior)
    for (const auto& [di, dj, dk] : std::vector<std::array<int, 3>>{
             {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      const VoxelIndex next{at.i + di, at.j + dj, at.k + dk};
      if (!interior.contains(next) && !surface.contains(next))
        return true;
    }
  return false;
}

TEST(Voxelise, EqualsEveryReferenceVector) {
  for (const std::string& name : vector_meshes()) {
    SCOPED_TRACE(name);
    const Voxels got = voxels(read_obj(name), vector_grid(name));
    std::vector<VoxelIndex> surface, interior;
    std::ifstream surface_file = open_vector("voxels/" + name + "_surface.csv");
    for (auto& row : read_csv(surface_file))
      surface.push_back({int(row["i"]), int(row["j"]), int(row["k"])});
    std::ifstream interior_file = open_vector("voxels/" + name + "_interior.csv");
    for (auto& row : read_csv(interior_file))
      for (int k = int(row["k_first"]); k <= int(row["k_last"]); ++k)
        interior.push_back({int(row["i"]), int(row["j"]), k});
    EXPECT_EQ(got.surface, surface);
    EXPECT_EQ(got.interior, interior);
    EXPECT_EQ(got.report.shells.open_parts, 0U);
    EXPECT_EQ(got.report.shells.closed_parts, 1U);
    EXPECT_FALSE(got.report.inside_out());
  }
}

TEST(Voxelise, TheDefaultGridStartsOneLayerBeforeTheUsedVertices) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    const double e = vector_grid(name).edge;
    const Vec3 origin = default_grid(mesh, e).origin;
    EXPECT_EQ(origin, vector_grid(name).origin + Vec3::Constant(e))
        << name << ": the vectors leave two layers";
  }
}

TEST(Voxelise, ScalingByPowersOfTwoChangesNoVoxel) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    const double edge = vector_grid(name).edge;
    const Voxels at_one = voxels(mesh, default_grid(mesh, edge));
    for (const double scale : {0x1p-20, 0x1p20}) {
      const mesh::TriangleMesh scaled = moved(mesh, Vec3::Zero(), scale);
      EXPECT_TRUE(voxels(scaled, default_grid(scaled, edge * scale)) == at_one)
          << name << ' ' << scale;
    }
  }
}

TEST(Voxelise, AFarPoseChangesNoVoxel) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    const double edge = vector_grid(name).edge;
    const mesh::TriangleMesh far = moved(mesh, Vec3(1e6, -1e6, 1e6));
    EXPECT_TRUE(voxels(far, default_grid(far, edge)) == voxels(mesh, default_grid(mesh, edge)))
        << name;
  }
}

TEST(Voxelise, ACubeOnTheGridHasNoHoleAndIsSymmetric) {
  const double e = 0.1;
  const Grid grid{Vec3::Constant(-1.0), e};
  const double ulp = std::nextafter(1.0, 2.0) - 1.0;
  for (const double shift : {0.0, ulp, -ulp, e / 2, -e / 2}) {
    const Voxels got = voxels(box(Vec3::Constant(-0.4 + shift), Vec3::Constant(0.4 + shift)), grid);
    EXPECT_FALSE(has_hole(got)) << shift;
    EXPECT_GE(got.interior.size(), 6U * 6U * 6U) << shift;
    // The cube's diagonal is an axis of symmetry: (i,j,k) and (j,k,i) are equivalent.
    const std::set<VoxelIndex> surface(got.surface.begin(), got.surface.end());
    for (const VoxelIndex& v : got.surface)
      ASSERT_TRUE(surface.contains({v.j, v.k, v.i})) << shift;
  }
  const Voxels exact = voxels(box(Vec3::Constant(1.0), Vec3::Constant(5.0)), {Vec3::Zero(), 1.0});
  EXPECT_EQ(exact.surface.size(), 6U * 6U * 6U - 2U * 2U * 2U);
  EXPECT_EQ(exact.interior.size(), 8U);
}

TEST(Voxelise, LitterOnTheSurfaceChangesNoVoxel) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    const Voxels littered_one = voxels(littered(mesh, 11), vector_grid(name));
    EXPECT_TRUE(littered_one == voxels(mesh, vector_grid(name))) << name;
    EXPECT_GT(littered_one.report.duplicates, 200U);
    EXPECT_GT(littered_one.report.zero_area, 400U);
  }
}

TEST(Voxelise, AnOpenMeshHasNoInterior) {
  for (const std::string& name : vector_meshes()) {
    mesh::TriangleMesh mesh = read_obj(name);
    mesh.triangles.erase(mesh.triangles.begin());
    const Voxels got = voxels(mesh, vector_grid(name));
    EXPECT_TRUE(got.interior.empty()) << name;
    EXPECT_EQ(got.report.shells.open_parts, 1U) << name;
  }
}

TEST(Voxelise, AHoleSmallerThanAVoxelIsAHole) {
  mesh::TriangleMesh fine = sphere(Vec3::Zero(), 1.0, 64);
  fine.triangles.pop_back();
  EXPECT_TRUE(voxels(fine, default_grid(fine, 0.25)).interior.empty());
}

TEST(Voxelise, AnInvertedMeshHasTheSameVoxels) {
  for (const std::string& name : vector_meshes()) {
    const mesh::TriangleMesh mesh = read_obj(name);
    const Voxels got = voxels(flipped(mesh), vector_grid(name));
    EXPECT_TRUE(got == voxels(mesh, vector_grid(name))) << name;
    EXPECT_TRUE(got.report.inside_out());
  }
}

TEST(Voxelise, SomeFlippedTrianglesChangeNothing) {
  for (const std::string& name : vector_meshes()) {
    mesh::TriangleMesh mesh = read_obj(name);
    const Voxels straight = voxels(mesh, vector_grid(name));
    std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
    std::swap(mesh.triangles[3][1], mesh.triangles[3][2]);
    const Voxels got = voxels(mesh, vector_grid(name));
    EXPECT_TRUE(got == straight) << name;
    EXPECT_GT(got.report.count(voxmap::ShellRole::kFlipped), 0U);
  }
}

TEST(Voxelise, NestedAndOverlappingShellsGoByWindingNumber) {
  const Grid grid{Vec3::Constant(-2.03), 0.1};
  const mesh::TriangleMesh outer = box(Vec3::Constant(-1.5), Vec3::Constant(1.5));
  const mesh::TriangleMesh inner = box(Vec3::Constant(-0.7), Vec3::Constant(0.7));
  const auto centre = [&](const mesh::TriangleMesh& mesh) {
    return voxelise(mesh, grid, serial_for()).at(Grid::voxel_of(grid.to_grid(Vec3::Zero())));
  };
  EXPECT_EQ(centre(joined(outer, flipped(inner))), VoxelKind::kFree) << "a cavity";
  EXPECT_EQ(centre(flipped(joined(outer, flipped(inner)))), VoxelKind::kFree)
      << "a cavity, all inside out";
  EXPECT_EQ(centre(joined(outer, inner)), VoxelKind::kInterior) << "a body in a body";
  EXPECT_EQ(
      centre(joined(joined(outer, flipped(inner)), box(Vec3::Constant(-0.3), Vec3::Constant(0.3)))),
      VoxelKind::kInterior)
      << "a body in a cavity";
  const mesh::TriangleMesh overlap = joined(box(Vec3(-1.5, -1, -1), Vec3(0.5, 1, 1)),
                                            box(Vec3(-0.5, -0.9, -0.9), Vec3(1.5, 0.9, 0.9)));
  EXPECT_EQ(centre(overlap), VoxelKind::kInterior);
  EXPECT_EQ(centre(joined(outer, outer)), VoxelKind::kInterior) << "the same mesh twice";
}

TEST(Voxelise, AnOpenPartTakesNothingFromAClosedOne) {
  const mesh::TriangleMesh solid = box(Vec3::Zero(), Vec3::Ones());
  mesh::TriangleMesh sheet = box(Vec3(2, 0, 0), Vec3(3, 1, 1));
  sheet.triangles.resize(10);
  const mesh::TriangleMesh both = joined(solid, sheet);
  const Voxels got = voxels(both, default_grid(both, 0.11)),
               alone = voxels(solid, default_grid(solid, 0.11));
  EXPECT_EQ(got.interior, alone.interior);
  EXPECT_EQ(got.report.shells.open_parts, 1U);
  EXPECT_EQ(got.report.shells.closed_parts, 1U);
}

TEST(Voxelise, StackedBoxesWithACommonWallStayClosed) {
  const mesh::TriangleMesh low = box(Vec3::Zero(), Vec3(1, 1, 1));
  mesh::TriangleMesh high = moved(low, Vec3(0, 0, 1));
  std::swap(high.triangles[8], high.triangles[9]);
  // The upper box's floor must use the same diagonal as the lower box's roof to be its duplicate.
  high.triangles[8] = {0, 3, 1}, high.triangles[9] = {0, 2, 3};
  const mesh::TriangleMesh both = joined(low, high);
  const Voxels got = voxels(both, {Vec3::Constant(-0.5), 0.11});
  EXPECT_EQ(got.report.duplicates, 2U);
  EXPECT_EQ(got.report.shells.open_parts, 0U);
  EXPECT_FALSE(got.interior.empty());
  EXPECT_FALSE(has_hole(got));
}

TEST(Voxelise, ATwoSidedFinTakesNothingFromABody) {
  mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Ones());
  const Grid grid{Vec3::Constant(-1.02), 0.11};
  const std::vector<VoxelIndex> without = voxels(mesh, grid).interior;
  mesh.vertices.push_back(Vec3(2, 2, 1));
  mesh.triangles.push_back({5, 7, 8});
  mesh.triangles.push_back({5, 8, 7});
  EXPECT_EQ(voxels(mesh, grid).interior, without);
  mesh.triangles.pop_back();
  EXPECT_TRUE(voxels(mesh, grid).interior.empty()) << "one-sided, the fin leaves its part open";
}

TEST(Voxelise, TwoCubesWithACommonEdgeAreSolid) {
  const mesh::TriangleMesh both =
      joined(box(Vec3::Zero(), Vec3::Ones()), box(Vec3(1, 1, 0), Vec3(2, 2, 1)));
  const Voxels got = voxels(both, default_grid(both, 0.11));
  EXPECT_EQ(got.report.shells.open_parts, 0U);
  EXPECT_FALSE(got.interior.empty());
  EXPECT_FALSE(has_hole(got));
}

TEST(Voxelise, AZeroAreaTriangleMayCloseATJunction) {
  mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Ones());
  // Split the edge 4-5 of one triangle only, and fill the slit with a zero-area triangle.
  mesh.vertices.push_back(Vec3(0.5, 0, 1));
  for (auto& t : mesh.triangles)
    if (t == std::array<std::uint32_t, 3>{4, 5, 7})
      t = {4, 8, 7};
  mesh.triangles.push_back({8, 5, 7});
  EXPECT_TRUE(voxels(mesh, default_grid(mesh, 0.11)).interior.empty()) << "the slit is open";
  mesh.triangles.push_back({4, 5, 8});
  const Voxels got = voxels(mesh, default_grid(mesh, 0.11));
  EXPECT_FALSE(got.interior.empty());
  EXPECT_EQ(got.report.shells.open_parts, 0U);
}

/// A Klein bottle as a figure of eight swept around with half a turn: closed, but without an
/// outside.
mesh::TriangleMesh klein_bottle(int n) {
  mesh::TriangleMesh mesh;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      const double u = 2 * std::numbers::pi * a / n, v = 2 * std::numbers::pi * (b + 0.5) / n;
      const double out = std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v);
      const double up = std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v);
      mesh.vertices.push_back({(3 + out) * std::cos(u), (3 + out) * std::sin(u), up});
    }
  const auto at = [n](int a, int b) {
    const int row = a == n ? n - 1 - b % n : b % n;  // after one round v has become -v
    return static_cast<std::uint32_t>((a % n) * n + row);
  };
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      mesh.triangles.push_back({at(a, b), at(a + 1, b), at(a + 1, b + 1)});
      mesh.triangles.push_back({at(a, b), at(a + 1, b + 1), at(a, b + 1)});
    }
  return mesh;
}

TEST(Voxelise, AShellThatCannotBeOrientedGoesByParity) {
  const mesh::TriangleMesh mesh = klein_bottle(40);
  const Voxels got = voxels(mesh, default_grid(mesh, 0.1));
  EXPECT_EQ(got.report.shells.closed_parts, 1U);
  EXPECT_EQ(got.report.count(voxmap::ShellRole::kParity), mesh.triangles.size());
  EXPECT_GT(got.interior.size(), 1000U);
  EXPECT_FALSE(has_hole(got));
}

TEST(Voxelise, InteriorEqualsTheWindingNumberOfEveryVoxel) {
  const mesh::TriangleMesh mesh =
      joined(sphere(Vec3(0.1, 0, 0), 1.0, 12), flipped(sphere(Vec3(0.1, 0, 0.2), 0.5, 9)));
  const Grid grid = default_grid(mesh, 0.13);
  const Voxmap map = voxelise(mesh, grid, serial_for());
  std::size_t inside = 0;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 20; ++k) {
        if (map.at({i, j, k}) == VoxelKind::kSurface)
          continue;
        double angle = 0.0;  // solid angle (van Oosterom and Strackee, 1983)
        const Vec3 c = grid.centre({i, j, k});
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
          const Vec3 a = mesh.corner(t, 0) - c, b = mesh.corner(t, 1) - c,
                     d = mesh.corner(t, 2) - c;
          angle += 2.0 * std::atan2(a.dot(b.cross(d)),
                                    a.norm() * b.norm() * d.norm() + a.dot(b) * d.norm() +
                                        b.dot(d) * a.norm() + d.dot(a) * b.norm());
        }
        const bool expected = std::abs(angle) / (4.0 * std::numbers::pi) >= 0.5;
        inside += expected;
        ASSERT_EQ(map.at({i, j, k}) == VoxelKind::kInterior, expected);
      }
  EXPECT_GT(inside, 500U);
}

TEST(Voxelise, TheOrderOfTheLoopChangesNothing) {
  for (const std::string& name : vector_meshes())
    EXPECT_TRUE(voxels(read_obj(name), vector_grid(name)) ==
                voxels(read_obj(name), vector_grid(name), scrambled_for()));
  const mesh::TriangleMesh fine = sphere(Vec3(0.01, 0.02, 0.03), 1.0, 40);
  EXPECT_TRUE(voxels(fine, default_grid(fine, 0.021)) ==
              voxels(fine, default_grid(fine, 0.021), scrambled_for()));
}

TEST(VoxelBudget, RefusesImpossibleSizesAtOnce) {
  const mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(100.0));
  const auto start = std::chrono::steady_clock::now();
  std::string said;
  try {
    voxelise(mesh, default_grid(mesh, 1e-3), serial_for());
  } catch (const VoxelBudgetError& error) {
    said = error.what();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(20));
  EXPECT_NE(said.find("100 m"), std::string::npos) << said;
  EXPECT_NE(said.find("0.001 m"), std::string::npos) << said;
  EXPECT_NE(said.find("TiB"), std::string::npos) << said;
}

TEST(VoxelBudget, RefusesByAGivenLimit) {
  const mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(1.0));
  const Grid grid = default_grid(mesh, 0.01);
  EXPECT_NO_THROW(voxelise(mesh, grid, serial_for(), 4 << 20));
  EXPECT_THROW(voxelise(mesh, grid, serial_for(), 1 << 18), VoxelBudgetError);
}

TEST(VoxelBudget, RefusesIndicesBeyondInt32AndNonFinite) {
  mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Ones());
  EXPECT_THROW(voxelise(mesh, {Vec3(-1e9, 0, 0), 0.1}, serial_for()), VoxelBudgetError);
  EXPECT_THROW(voxelise(mesh, {Vec3(-1e300, 0, 0), 1e-300}, serial_for()), VoxelBudgetError);
  EXPECT_THROW(voxelise(mesh, {Vec3(NAN, 0, 0), 0.1}, serial_for()), std::runtime_error);
  for (const double edge : {0.0, -1.0, double(NAN), double(INFINITY)})
    EXPECT_THROW(voxelise(mesh, {Vec3::Zero(), edge}, serial_for()), std::runtime_error);
  EXPECT_THROW(voxelise(mesh::TriangleMesh{}, {}, serial_for()), std::runtime_error);
  mesh::TriangleMesh bad_index = mesh;
  bad_index.triangles[3][1] = 99;
  EXPECT_THROW(voxelise(bad_index, {}, serial_for()), std::runtime_error);
  for (const double poison : {double(NAN), double(INFINITY), -double(INFINITY)})
    for (std::size_t v = 0; v < 8; ++v) {
      mesh::TriangleMesh bad = mesh;
      bad.vertices[v][static_cast<Eigen::Index>(v % 3)] = poison;
      try {
        default_grid(bad, 0.1);
        FAIL();
      } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("vertex " + std::to_string(v)), std::string::npos);
      }
    }
}

TEST(VoxelBudget, RefusesMoreVoxelsThanForeseen) {
  mesh::TriangleMesh specks;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> pick(0.0, 1.0);
  for (std::uint32_t n = 0; n < 20000; ++n) {
    const Vec3 x(pick(random), pick(random), pick(random));
    for (const Vec3& d : {Vec3(0, 0, 0), Vec3(1e-5, 0, 0), Vec3(0, 1e-5, 0)})
      specks.vertices.push_back(x + d);
    specks.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  const Grid grid = default_grid(specks, 0.005);
  const auto foreseen = static_cast<std::uint64_t>(estimate_voxels(specks, grid).build_bytes);
  EXPECT_THROW(voxelise(specks, grid, serial_for(), foreseen + 1000), VoxelBudgetError);
  EXPECT_NO_THROW(voxelise(specks, grid, serial_for(), foreseen + 20000 * 512));
}

TEST(VoxelBudget, TheEstimateIsCloseToTheTruth) {
  const mesh::TriangleMesh mesh = sphere(Vec3::Zero(), 1.0, 64);
  for (const double edge : {0.05, 0.01, 0.004}) {
    const Grid grid = default_grid(mesh, edge);
    const double said = estimate_voxels(mesh, grid).bytes;
    const auto used = static_cast<double>(voxelise(mesh, grid, serial_for()).bytes());
    EXPECT_GE(said, 0.9 * used) << edge;
    EXPECT_LE(said, 2.2 * used) << edge;  // it reports up to twice as many bricks as exist
  }
}

TEST(Voxelise, DenormalAndTinyVerticesDoNoHarm) {
  mesh::TriangleMesh mesh = box(Vec3::Zero(), Vec3::Ones());
  mesh.vertices[0] = Vec3(5e-324, -5e-324, 1e-310);
  const Voxels got = voxels(mesh, {Vec3::Zero(), 0.125});
  EXPECT_FALSE(got.interior.empty());
  EXPECT_FALSE(has_hole(got));
}

}  // namespace
}  // namespace voxtouch::voxmap

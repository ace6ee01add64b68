/// Rows V1 to V6 and V8 of the table of hard cases: static meshes.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/mesh/report.hpp"
#include "core/mesh/weld.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/hard/geometry/rig.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/voxel_report.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::hard {
namespace {

using test::box_mesh, test::inside_out, test::joined, test::sphere_mesh;

// -------------------------------------------------------------------------------------------------
// V1

/// Voxels that a walk over faces reaches from outside without crossing a surface voxel, in a box of
/// `n` voxels a side about 0.
std::set<voxmap::VoxelIndex> flooded(const voxmap::Voxmap& map, int n) {
  std::set<voxmap::VoxelIndex> seen{{-n, -n, -n}};
  std::vector<voxmap::VoxelIndex> walk{{-n, -n, -n}};
  while (!walk.empty()) {
    const voxmap::VoxelIndex v = walk.back();
    walk.pop_back();
    for (const voxmap::VoxelIndex& next : {voxmap::VoxelIndex{v.i + 1, v.j, v.k},
                                           {v.i - 1, v.j, v.k},
                                           {v.i, v.j + 1, v.k},
                                           {v.i, v.j - 1, v.k},
                                           {v.i, v.j, v.k + 1},
                                           {v.i, v.j, v.k - 1}})
      if (std::max({std::abs(next.i), std::abs(next.j), std::abs(next.k)}) <= n &&
          map.at(next) != voxmap::VoxelKind::kSurface && seen.insert(next).second)
        walk.push_back(next);
  }
  return seen;
}

/// A cube of 2 * 4 voxels, each of its six planes shifted along its axis by one of these.
double shifted(double x, int which, double e) {
  switch (which) {
    case 1:
      return std::nextafter(x, INFINITY);
    case 2:
      return std::nextafter(x, -INFINITY);
    case 3:
      return x + e / 2;
    case 4:
      return x - e / 2;
    default:
      return x;
  }
}

TEST(V1PointOnAFace, FloodStaysOutAndMirrorsMatch) {
  constexpr double e = 0x1p-4;
  const voxmap::Grid grid{Vec3::Zero(), e};
  const std::array<int, 5> mirrored{0, 2, 1, 4, 3};
  for (int code = 0; code < 125; ++code) {
    const std::array<int, 3> which{code % 5, code / 5 % 5, code / 25};
    mesh::TriangleMesh cube = box_mesh(Vec3::Constant(8 * e)), mirror = cube;
    for (std::size_t v = 0; v < 8; ++v)
      for (int a = 0; a < 3; ++a) {
        const int w = which[static_cast<std::size_t>(a)];
        cube.vertices[v][a] = shifted(cube.vertices[v][a], w, e);
        mirror.vertices[v][a] =
            shifted(mirror.vertices[v][a], mirrored[static_cast<std::size_t>(w)], e);
      }
    const voxmap::Voxmap map = voxmap::voxelise(cube, grid, serial_for());
    for (const voxmap::VoxelIndex& v : flooded(map, 8)) {
      ASSERT_EQ(map.at(v), voxmap::VoxelKind::kFree) << code;
      ASSERT_GT(Vec3(v.i + 0.5, v.j + 0.5, v.k + 0.5).cwiseAbs().maxCoeff(), 3.0)
          << "the flood came in, shift " << code;
    }
    ASSERT_GE(map.interior_count(), 6U * 6U * 6U) << code;
    std::vector<std::pair<voxmap::VoxelIndex, voxmap::VoxelKind>> voxels = voxels_of(map);
    for (auto& [v, kind] : voxels)
      v = {-1 - v.i, -1 - v.j, -1 - v.k};
    std::sort(voxels.begin(), voxels.end());
    ASSERT_EQ(voxels, voxels_of(voxmap::voxelise(mirror, grid, serial_for()))) << code;
  }
}

/// Every second voxel is surface, like a chessboard's: a point in a neighbour's voxel would be
/// seen.
voxmap::Voxmap chessboard(const voxmap::Grid& grid, int n) {
  voxmap::Voxmap map(grid, {-n, -n, -n}, {n, n, n});
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k)
        if ((i + j + k) % 2 != 0)
          map.set({i, j, k}, voxmap::VoxelKind::kSurface);
  map.finish();
  return map;
}

TEST(V1PointOnAFace, EdgesAndCornersHitOneVoxel) {
  constexpr double e =
      0.0037;  // not a power of two: its multiples are on the border, or an ulp off
  const voxmap::Grid grid{Vec3(0.1, -0.2, 0.3), e};
  const voxmap::Voxmap map = chessboard(grid, 5);
  Random random(1);
  pointshell::Pointshell shell;
  std::vector<Vec3> points;
  for (int n = 0; n < 3 * 32 + 13;
       ++n) {  // whole leaves and the rest of one: the processor's wide and narrow paths
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      const double border = static_cast<double>(random() % 9) - 4.0;
      x[a] = shifted(border * e, static_cast<int>(random() % 3), e);
    }
    points.push_back(x);
    shell.x.push_back(x.x()), shell.y.push_back(x.y()), shell.z.push_back(x.z());
    shell.nx.push_back(0.0), shell.ny.push_back(0.0), shell.nz.push_back(1.0);
    shell.area_m2.push_back(1.0), shell.coherence.push_back(1.0),
        shell.id.push_back(static_cast<std::uint32_t>(n));
  }
  const contact::ContactQuery query(map, shell);
  contact::HitList hits, again;
  hits.reserve(shell.size()), again.reserve(shell.size());
  for (int n = 0; n < 50; ++n) {
    const Pose pose{grid.origin + (n == 0 ? 0.0 : e) * Vec3(n % 3 - 1, n % 2, -1),
                    n < 6 ? Quat::Identity() : any_rotation(random)};
    query.find(pose, hits);
    query.find(pose, again);
    Quat q = pose.orientation;
    normalise_within(q, 0.5, 2.0);
    const Mat3 r = q.toRotationMatrix();
    const Vec3 t = pose.position - grid.origin;
    std::map<std::uint32_t, Vec3> to_centre;
    for (const contact::Hit& hit : hits.surface)
      ASSERT_TRUE(to_centre.emplace(hit.point, hit.to_centre).second) << "hit twice";
    ASSERT_EQ(hits.surface.size(), again.surface.size());
    for (std::uint32_t p = 0; p < points.size(); ++p) {
      Vec3 u;  // one multiplication and addition after the other, as IEEE 754 has them
      for (int a = 0; a < 3; ++a)
        u[a] =
            (r(a, 0) * points[p].x() + r(a, 1) * points[p].y() + r(a, 2) * points[p].z() + t[a]) /
            e;
      const voxmap::VoxelIndex v{static_cast<int>(std::floor(u.x())),
                                 static_cast<int>(std::floor(u.y())),
                                 static_cast<int>(std::floor(u.z()))};
      ASSERT_EQ(to_centre.contains(p), map.at(v) == voxmap::VoxelKind::kSurface)
          << p << " at " << u.transpose();
      if (to_centre.contains(p)) {
        ASSERT_EQ(to_centre[p],
                  Vec3(e * Vec3(v.i + 0.5 - u.x(), v.j + 0.5 - u.y(), v.k + 0.5 - u.z())));
      }
    }
  }
}

// -------------------------------------------------------------------------------------------------
// V2

/// With 1000 additional triangles, all on the surface: four kinds of zero-area ones, slivers 1e-12
/// m wide, duplicates in both orientations.
mesh::TriangleMesh littered(mesh::TriangleMesh mesh, Random& random) {
  const std::size_t sound = mesh.triangles.size();
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& x : {a, b, c})
      mesh.vertices.push_back(x);
    mesh.triangles.push_back({v, v + 1, v + 2});
  };
  for (int n = 0; n < 1000; ++n) {
    const auto t = mesh.triangles[random() % sound];
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    switch (n % 7) {
      case 0:
        mesh.triangles.push_back({t[0], t[0], t[1]});
        break;
      case 1:
        mesh.triangles.push_back({t[2], t[2], t[2]});
        break;
      case 2:
        add(a, 0.5 * (a + b), b);
        break;
      case 3:
        add(c, c, c);
        break;
      case 4:
        mesh.triangles.push_back({t[1], t[2], t[0]});
        break;
      case 5:
        mesh.triangles.push_back({t[0], t[2], t[1]});
        break;
      default: {
        const Vec3 from = 0.5 * a + 0.25 * b + 0.25 * c, to = 0.25 * a + 0.5 * b + 0.25 * c;
        add(from, to, to + 1e-12 * (c - a).normalized());
      }
    }
  }
  return mesh;
}

TEST(V2DegenerateTriangles, ChangeNeitherVoxelsNorForce) {
  const std::uint64_t seed = testing::seed(82);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const mesh::TriangleMesh bad_ground = littered(ground, random), bad_tool = littered(tool, random);
  const Rig clean(ground, tool), dirty(bad_ground, bad_tool);
  ASSERT_EQ(voxels_of(clean.voxmap), voxels_of(dirty.voxmap));
  ASSERT_EQ(clean.shell.id, dirty.shell.id);
  for (std::size_t p = 0; p < clean.shell.size(); ++p) {
    ASSERT_TRUE(dirty.shell.point(p).allFinite() && dirty.shell.normal(p).allFinite());
    ASSERT_LT((clean.shell.point(p) - dirty.shell.point(p)).norm(), 2e-12)
        << p;  // width of a sliver
    ASSERT_LT((clean.shell.normal(p) - dirty.shell.normal(p)).norm(), 1e-7)
        << p;  // a sliver's fraction of the voxel's area
    ASSERT_NEAR(dirty.shell.normal(p).norm(), 1.0, 1e-14) << p;
  }
  Off off;
  for (const Pose& pose : touching_poses(ground, 300, random))
    off.note(clean, pose, clean.probe(pose), dirty.probe(pose));
  std::printf("%s\n", off.text().c_str());
  EXPECT_GE(off.touching, 150U);
  for (std::size_t m = 0; m < kModels.size(); ++m)
    EXPECT_LT(off.metres[m], 1e-9) << model_name(m);
  const test::VoxelReport found =
      test::voxel_report(bad_ground, voxmap::default_grid(bad_ground, kEdge));
  EXPECT_EQ(found.zero_area, 143U + 143U + 143U + 143U);
  EXPECT_GE(found.duplicates, 143U + 143U);
  EXPECT_GT(found.shells.open_parts, 50U) << "the slivers, some of which hang together";
  const mesh::MeshReport said = mesh::inspect(bad_ground);
  EXPECT_EQ(said.zero_area.count, found.zero_area + 0U);
  EXPECT_EQ(said.duplicates.count + said.opposite_duplicates.count, found.duplicates);
}

// -------------------------------------------------------------------------------------------------
// V3

struct Defect {
  const char* name;
  mesh::TriangleMesh mesh;
  bool closed;  ///< has an inside all the same
};

/// A box of 10 x 8 x 6 voxels, tilted out of the grid.
mesh::TriangleMesh tilted_box(const Vec3& at = Vec3::Zero()) {
  return box_mesh(kEdge * Vec3(10, 8, 6),
                  {at, Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()))});
}

mesh::TriangleMesh moebius(double radius, double width, int n) {
  mesh::TriangleMesh mesh;
  for (int a = 0; a < n; ++a)
    for (const double side : {-0.5, 0.5}) {
      const double turn = 2 * std::numbers::pi * a / n,
                   out = radius + side * width * std::cos(turn / 2);
      mesh.vertices.emplace_back(out * std::cos(turn), out * std::sin(turn),
                                 side * width * std::sin(turn / 2));
    }
  for (int a = 0; a < n; ++a) {
    const auto low = static_cast<std::uint32_t>(2 * a), high = low + 1;
    const bool last = a + 1 == n;
    const std::uint32_t next_low = last ? 1 : low + 2, next_high = last ? 0 : low + 3;
    mesh.triangles.push_back({low, next_low, next_high});
    mesh.triangles.push_back({low, next_high, high});
  }
  return mesh;
}

std::vector<Defect> defects() {
  std::vector<Defect> all;
  mesh::TriangleMesh hole = tilted_box(), one = hole;
  hole.triangles.erase(hole.triangles.begin());
  std::swap(one.triangles[7][1], one.triangles[7][2]);
  all.push_back({"one face removed", hole, false});
  all.push_back({"one face inverted", one, true});
  all.push_back({"all faces inverted", inside_out(tilted_box()), true});
  // Two boxes with a common edge: the corners (+,+,*) of one are the corners (-,-,*) of the other.
  const Quat turn(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()));
  mesh::TriangleMesh first = tilted_box(), second = tilted_box(turn * (kEdge * Vec3(10, 8, 0)));
  second.vertices[0] = first.vertices[3], second.vertices[4] = first.vertices[7];
  all.push_back({"two boxes that share an edge", joined(first, second), true});
  all.push_back(
      {"two boxes that share an edge, one inverted", joined(first, inside_out(second)), true});
  all.push_back({"two boxes, one inverted",
                 joined(first, inside_out(tilted_box(kEdge * Vec3(20, 0, 0)))), true});
  return all;
}

std::vector<Vec3> outward_normals(const mesh::TriangleMesh& mesh, const Vec3& middle) {
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 n = (mesh.corner(t, 1) - mesh.corner(t, 0))
                       .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                       .normalized();
    normals.push_back(n.dot(mesh.corner(t, 0) - middle) < 0.0 ? Vec3(-n) : n);
  }
  return normals;
}

/// Distance of a point from the other of two boxes, which the force of the one at hand must not be
/// mixed with.
double distance_from_box(const Vec3& x, const Vec3& middle, const Quat& turn) {
  const Vec3 local = (turn.conjugate() * (x - middle)).cwiseAbs() - kEdge * Vec3(5, 4, 3);
  return local.cwiseMax(0.0).norm();
}

/// Convex pieces of 12 triangles each, or 11 and 12 with one missing.
Vec3 middle_of_piece(const mesh::TriangleMesh& mesh, std::size_t triangle) {
  const std::size_t first = triangle < 12 || mesh.vertices.size() == 8 ? 0 : 8;
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = first; v < first + 8; ++v)
    sum += mesh.vertices[v] / 8.0;
  return sum;
}

TEST(V3OpenNonManifoldInverted, StaticSceneNeverPullsInward) {
  const double r = 3.3 * kEdge;
  const mesh::TriangleMesh ball = sphere_mesh(r, 2);
  for (const Defect& defect : defects()) {
    SCOPED_TRACE(defect.name);
    const Rig rig(defect.mesh, ball);
    EXPECT_EQ(rig.models[kField] != nullptr, defect.closed);
    std::array<int, kModels.size()> pushes{};
    for (std::size_t t = 0; t < defect.mesh.triangles.size(); ++t) {
      const Vec3 normal = outward_normals(defect.mesh, middle_of_piece(defect.mesh, t))[t];
      const Vec3 middle =
          (defect.mesh.corner(t, 0) + defect.mesh.corner(t, 1) + defect.mesh.corner(t, 2)) / 3.0;
      const Vec3 own = middle_of_piece(defect.mesh, t),
                 other = middle_of_piece(defect.mesh, t < 12 ? 12 : 0);
      const Quat turn(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()));
      for (double depth = -0.5; depth <= 0.6; depth += 0.1) {
        const Vec3 at = middle + (r - depth * kEdge) * normal;
        if (own != other && distance_from_box(at, other, turn) < r + 2 * kEdge)
          continue;
        const Answers answers = rig.probe({at, Quat::Identity()});
        for (std::size_t m = 0; m < kModels.size(); ++m) {
          ASSERT_GE(answers[m].wrench.force.dot(normal), 0.0)
              << model_name(m) << " triangle " << t << " depth " << depth;
          pushes[m] += answers[m].wrench.force.dot(normal) > 0.0;
        }
      }
    }
    for (std::size_t m = 0; m < (defect.closed ? kModels.size() : kField); ++m)
      EXPECT_GT(pushes[m], 11) << model_name(m);
  }
}

TEST(V3OpenNonManifoldInverted, ToolIsNeverPulledIn) {
  Pose down;
  down.position.z() = -8 * kEdge;
  const mesh::TriangleMesh ground = box_mesh(kEdge * Vec3(90, 90, 16), down);
  for (const Defect& defect : defects()) {
    SCOPED_TRACE(defect.name);
    const Rig rig(ground, defect.mesh);
    std::array<int, kModels.size()> pushes{};
    Random random(3);
    for (std::size_t t = 0; t < defect.mesh.triangles.size(); ++t) {
      // Placed with this triangle's plane on the static mesh, slightly rotated.
      const Vec3 normal = outward_normals(defect.mesh, middle_of_piece(defect.mesh, t))[t];
      const Quat lay =
          Quat(Eigen::AngleAxisd(
              0.05, Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 0).normalized())) *
          Quat::FromTwoVectors(normal, -Vec3::UnitZ());
      double lowest = INFINITY;
      for (const Vec3& v : defect.mesh.vertices)
        lowest = std::min(lowest, (lay * v).z());
      for (double depth = -0.5; depth <= 0.8; depth += 0.1) {
        const Answers answers =
            rig.probe({Vec3(0.3 * kEdge, 0.4 * kEdge, -lowest - depth * kEdge), lay});
        for (std::size_t m = 0; m < kModels.size(); ++m) {
          // The sides, upright to 0.05 rad, act along their normals if `original` finds them in the
          // layer.
          ASSERT_GE(answers[m].wrench.force.z(), -0.0501 * answers[m].wrench.force.norm())
              << model_name(m) << " triangle " << t << " depth " << depth;
          pushes[m] += answers[m].wrench.force.z() > 0.0;
        }
      }
    }
    for (std::size_t m = 0; m < kModels.size(); ++m)
      EXPECT_GT(pushes[m], 20) << model_name(m);
  }
}

TEST(V3OpenNonManifoldInverted, MoebiusBandRepelsOnBothSides) {
  const mesh::TriangleMesh band = moebius(14 * kEdge, 8 * kEdge, 48);
  const double r = 3.3 * kEdge;
  const Rig rig(band, sphere_mesh(r, 2));
  EXPECT_EQ(rig.models[kField], nullptr);
  EXPECT_EQ(rig.voxmap.interior_count(), 0U);
  int pushes = 0;
  for (std::size_t t = 0; t < band.triangles.size(); ++t)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 middle = (band.corner(t, 0) + band.corner(t, 1) + band.corner(t, 2)) / 3.0;
      const Vec3 away = side * (band.corner(t, 1) - band.corner(t, 0))
                                   .cross(band.corner(t, 2) - band.corner(t, 0))
                                   .normalized();
      const Answers answers = rig.probe({middle + (r - 0.2 * kEdge) * away, Quat::Identity()});
      for (std::size_t m = 0; m < 3; ++m) {
        ASSERT_GE(answers[m].wrench.force.dot(away), 0.0) << model_name(m) << ' ' << t;
        pushes += answers[m].wrench.force.dot(away) > 0.0;
      }
    }
  EXPECT_GT(pushes, 100);
}

TEST(V3OpenNonManifoldInverted, EachIsCountedAndNamed) {
  const std::vector<Defect> all = defects();
  const auto report = [](const mesh::TriangleMesh& mesh) {
    return test::voxel_report(mesh, voxmap::default_grid(mesh, kEdge));
  };
  EXPECT_EQ(report(all[0].mesh).shells.open_parts, 1U);
  EXPECT_EQ(mesh::inspect(all[0].mesh).open_edges.count, 3U);
  EXPECT_EQ(report(all[1].mesh).count(voxmap::ShellRole::kFlipped), 1U);
  EXPECT_EQ(mesh::inspect(all[1].mesh).flipped.examples, std::vector<std::uint32_t>{7});
  EXPECT_TRUE(report(all[2].mesh).inside_out());
  EXPECT_TRUE(mesh::inspect(all[2].mesh).inverted);
  EXPECT_EQ(mesh::inspect(all[3].mesh).non_manifold_edges.count, 1U);
  EXPECT_EQ(mesh::inspect(all[5].mesh).inward_parts.count, 1U);
  EXPECT_FALSE(mesh::inspect(moebius(0.03, 0.01, 48)).orientable);
  EXPECT_EQ(report(moebius(0.03, 0.01, 48)).shells.open_parts, 1U);
  for (const Defect& defect : all)
    EXPECT_FALSE(mesh::inspect(defect.mesh).sentences().empty()) << defect.name;
}

TEST(V3OpenNonManifoldInverted, CavityWallFacesTheCavity) {
  const double e = kEdge;
  const mesh::TriangleMesh outer = box_mesh(Vec3::Constant(20.3 * e)),
                           inner = box_mesh(Vec3::Constant(9.7 * e));
  for (const mesh::TriangleMesh& mesh :
       {joined(outer, inside_out(inner)), inside_out(joined(outer, inside_out(inner)))}) {
    const pointshell::Pointshell shell = test::exact_shell(mesh, e);
    for (std::size_t p = 0; p < shell.size(); ++p) {
      const bool of_cavity = shell.point(p).cwiseAbs().maxCoeff() < 7.0 * e;
      ASSERT_EQ(shell.normal(p).dot(shell.point(p)) > 0.0, of_cavity)
          << p;  // into the solid between them
    }
  }
}

// -------------------------------------------------------------------------------------------------
// V4

TEST(V4OffsetOfAMillionMetres, ForceChangesByRoundingOnly) {
  const std::uint64_t seed = testing::seed(84);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const Vec3 far(1e6 + 0.123456789, -1e6 + 0.3, 1e6 - 0.7);
  // Arbitrary factor, so that every vertex and pose is rounded.
  const mesh::TriangleMesh ground = mesh::transform(ground_mesh(), 1.0 + 1e-3 / 3.0, {});
  const pointshell::Pointshell shell = test::exact_shell(tool_mesh(), kEdge);
  const voxmap::Grid grid = voxmap::default_grid(ground, kEdge);
  const Rig here(ground, grid, shell);
  const Rig there(mesh::transform(ground, 1.0, {far, Quat::Identity()}), {grid.origin + far, kEdge},
                  shell);
  ASSERT_EQ(voxels_of(here.voxmap), voxels_of(there.voxmap));
  constexpr double kFourUlps = 4.0 * 0x1p-33;
  Off off;
  int near_border = 0, rounded = 0;
  for (Pose pose : touching_poses(ground, 1000, random)) {
    pose.position *= 1.0 + 1e-7 / 3.0;
    const Answers a = here.probe(pose);
    bool border = false;  // there a rounding decides which voxel holds the point
    for (const contact::Hit& hit : here.models[0]->hits().surface)
      border = border || hit.to_centre.cwiseAbs().maxCoeff() > 0.5 * kEdge - 2 * kFourUlps;
    near_border += border;
    if (!border)
      off.note(here, pose, a, there.probe({pose.position + far, pose.orientation}));
    rounded += Vec3(pose.position + far - far) != pose.position;
  }
  std::printf("%s\n", off.text().c_str());
  EXPECT_LE(near_border, 10);
  EXPECT_GT(rounded, 900);
  EXPECT_GE(off.touching, 800U);
  for (std::size_t m = 0; m < kModels.size(); ++m)
    EXPECT_LE(off.metres[m], kFourUlps) << model_name(m);
}

// -------------------------------------------------------------------------------------------------
// V6

TEST(V6TooManyVoxels, AreRefusedBeforeMemoryIsSpent) {
  const mesh::TriangleMesh mesh = sphere_mesh(50.0, 3);
  const voxmap::Grid grid = voxmap::default_grid(mesh, 100.0 / 1e5);
  const auto refused = [&](const auto& build) {
    std::string sentence;
    const auto ask = [&] {
      try {
        build();
      } catch (const voxmap::VoxelBudgetError& error) {
        sentence = error.what();
      }
    };
    if (test::heap_is_counted()) {
      EXPECT_LT(test::heap_use_of(ask).bytes, 8192U) << "only the sentence";
    } else {
      ask();
    }
    EXPECT_NE(sentence.find("100 m long"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("0.001 m"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("iB"), std::string::npos) << sentence;
  };
  refused([&] { voxmap::voxelise(mesh, grid, serial_for()); });
  refused([&] { pointshell::shell_points(mesh, grid, serial_for()); });
}

// -------------------------------------------------------------------------------------------------
// V8

TEST(V8InvalidVertices, AreRefusedByIndexOrHarmless) {
  const double inf = INFINITY;
  const voxmap::Grid grid{kEdge * Vec3::Constant(-9.0), kEdge};
  int refused = 0, built = 0;
  for (const double poison :
       {double(NAN), inf, -inf, 1e308, -1e308, 1e30, 5e-324, -5e-324, 2e-308, -0.0})
    for (std::size_t c = 0; c < 24; ++c) {
      mesh::TriangleMesh mesh = tilted_box();
      mesh.vertices[c / 3][static_cast<Eigen::Index>(c % 3)] = poison;
      const bool number = std::isfinite(poison), small = std::abs(poison) < 1e30;
      const std::string name = "vertex " + std::to_string(c / 3) + ' ';
      const auto says = [&](const auto& build) {
        try {
          build();
          ++built;
          EXPECT_TRUE(number && small) << poison << ' ' << c;
        } catch (const std::runtime_error& error) {
          ++refused;
          EXPECT_FALSE(number && small) << error.what();
          const std::string said = error.what();
          EXPECT_NE(said.find(number ? "voxel size" : name), std::string::npos) << said;
        }
      };
      says([&] { voxmap::voxelise(mesh, grid, serial_for()); });
      if (std::abs(poison) < 1e300 || !number)
        says([&] { voxmap::voxelise(mesh, voxmap::default_grid(mesh, kEdge), serial_for()); });
      says([&] {
        for (const pointshell::ShellPoint& p : pointshell::shell_points(mesh, grid, serial_for()))
          ASSERT_TRUE(p.point.allFinite() && p.normal.allFinite() && std::isfinite(p.area_m2));
      });
      if (number && small) {
        const Rig rig(mesh, grid, test::exact_shell(sphere_mesh(3 * kEdge, 1), kEdge));
        for (const contact::ContactResult& r : rig.probe({Vec3(0, 0, 5 * kEdge), Quat::Identity()}))
          ASSERT_TRUE(r.wrench.finite() && r.stiffness.allFinite());
      }
      const mesh::MeshReport report = mesh::inspect(mesh);
      EXPECT_EQ(report.not_finite_vertices.count, number ? 0U : 1U);
      if (!number) {
        EXPECT_EQ(report.not_finite_vertices.examples,
                  std::vector<std::uint32_t>{static_cast<std::uint32_t>(c / 3)});
      }
    }
  EXPECT_GT(refused, 24 * 5);
  EXPECT_GT(built, 24 * 4);
}

}  // namespace
}  // namespace voxtouch::hard

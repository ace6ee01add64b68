/// Invariances of the displayed force: position, rotation and mirroring of the scene, units of a
/// power of two, order of triangles and points, number of threads, subdivision of flat faces.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/types/fnv.hpp"
#include "core/voxmap/voxelise.hpp"
#include "nodes/runtime/parallel_for.hpp"
#include "tests/hard/geometry/rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::hard {
namespace {

/// Permitted difference of depths: two ulps of a coordinate of 0.05 m. The field's nodes are single
/// precision: a different rounding is 2^-24 * 4 voxels * e = 4.7e-10 m, for one point among many.
constexpr double kRounding = 0x1p-56, kFieldRounding = 1e-10;

void expect_rounding(const Off& off, std::size_t poses) {
  std::printf("%s\n", off.text().c_str());
  EXPECT_GE(off.touching, poses / 2);
  for (std::size_t m = 0; m < kField; ++m)
    EXPECT_LE(off.metres[m], kRounding) << model_name(m);
  EXPECT_LE(off.metres[kField], kFieldRounding);
}

mesh::TriangleMesh moved(mesh::TriangleMesh mesh, const Vec3& by, double scale = 1.0) {
  for (Vec3& v : mesh.vertices)
    v = scale * v + by;
  return mesh;
}

Vec3 whole_voxels(Random& random, double most_m) {
  const double most = most_m / kEdge;
  return kEdge * Vec3(std::round(uniform(random, -most, most)),
                      std::round(uniform(random, -most, most)),
                      std::round(uniform(random, -most, most)));
}

TEST(Translation, ByGridMultiplesIsBitIdentical) {
  const std::uint64_t seed = testing::seed(71);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const Rig here(ground, tool);
  std::size_t touching = 0;
  for (const double far : {1.0, 1e3, 1e6}) {
    const Vec3 by = whole_voxels(random, far);
    const Rig there(moved(ground, by), tool);
    ASSERT_EQ(voxels_of(here.voxmap), voxels_of(there.voxmap));
    for (const Pose& pose : touching_poses(ground, 200, random)) {
      const Answers a = here.probe(pose), b = there.probe({pose.position + by, pose.orientation});
      for (std::size_t m = 0; m < kModels.size(); ++m)
        ASSERT_TRUE(same_bits(a[m], b[m])) << model_name(m) << " at " << by.transpose();
      touching += !a[0].wrench.zero();
    }
  }
  EXPECT_GE(touching, 300U);
}

TEST(Translation, WithinTheGridShiftsVoxelsOnly) {
  const std::uint64_t seed = testing::seed(72);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh();
  const voxmap::Grid grid{Vec3::Zero(), kEdge};
  const pointshell::Pointshell shell = test::exact_shell(tool_mesh(), kEdge);
  const Rig here(ground, grid, shell);
  const std::vector<Pose> poses = touching_poses(ground, 200, random);
  Off off;
  for (int n = 0; n < 3; ++n) {  // by no multiple of a brick's eight voxels
    const Vec3 by = whole_voxels(random, 0.05);
    const Rig there(moved(ground, by), grid, shell);
    auto shifted = voxels_of(here.voxmap);
    for (auto& [v, kind] : shifted)
      v.i += static_cast<int>(by.x() / kEdge), v.j += static_cast<int>(by.y() / kEdge),
          v.k += static_cast<int>(by.z() / kEdge);
    ASSERT_EQ(shifted, voxels_of(there.voxmap)) << by.transpose();
    for (const Pose& pose : poses)
      off.note(here, pose, here.probe(pose), there.probe({pose.position + by, pose.orientation}));
  }
  expect_rounding(off, 3 * poses.size());
}

/// A symmetry of the cube: +-1 in one place of each row and column.
std::vector<Mat3> cube_symmetries() {
  std::vector<Mat3> all;
  std::array<int, 3> order{0, 1, 2};
  do
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 s = Mat3::Zero();
      for (int row = 0; row < 3; ++row)
        s(row, order[static_cast<std::size_t>(row)]) = signs >> row & 1 ? -1.0 : 1.0;
      all.push_back(s);
    }
  while (std::next_permutation(order.begin(), order.end()));
  return all;
}

struct Symmetry {
  Mat3 matrix;
  double sign;  ///< -1: mirrors
  explicit Symmetry(const Mat3& s) : matrix(s), sign(std::round(s.determinant())) {}
  Vec3 axis(const Vec3& x) const { return sign * (matrix * x); }  ///< of torques and rotations
  mesh::TriangleMesh mesh(mesh::TriangleMesh m) const {
    for (Vec3& v : m.vertices)
      v = matrix * v;
    return sign < 0.0 ? test::inside_out(std::move(m)) : m;
  }
  Pose pose(const Pose& p) const {
    Quat q = p.orientation;
    q.vec() = axis(q.vec());
    return {matrix * p.position, q};
  }
  contact::ContactResult result(contact::ContactResult r) const {
    r.wrench = {matrix * r.wrench.force, axis(r.wrench.torque)};
    return r;
  }
  voxmap::VoxelIndex voxel(
      const voxmap::VoxelIndex& v) const {  // of the cube [v, v + 1], mirrored in the origin
    const Vec3 u = matrix * Vec3(v.i + 0.5, v.j + 0.5, v.k + 0.5);
    return voxmap::Grid::voxel_of(u);
  }
};

/// All 24 rotations of the cube and its 24 mirror images.
TEST(CubeSymmetry, RotatesAndMirrorsVoxelsShellAndForce) {
  const std::uint64_t seed = testing::seed(73);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const voxmap::Grid grid{Vec3::Zero(), kEdge};
  const Rig here(ground, grid, test::exact_shell(tool, grid));
  const std::vector<Pose> poses = touching_poses(ground, 25, random);
  Off off;
  for (const Mat3& matrix : cube_symmetries()) {
    const Symmetry s(matrix);
    const Rig there(s.mesh(ground), grid, test::exact_shell(s.mesh(tool), grid));
    auto expected = voxels_of(here.voxmap);
    for (auto& [v, kind] : expected)
      v = s.voxel(v);
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(expected, voxels_of(there.voxmap)) << matrix;
    ASSERT_EQ(here.shell.size(), there.shell.size());
    for (const Pose& pose : poses) {
      Answers a = here.probe(pose);
      for (contact::ContactResult& r : a)
        r = s.result(r);
      const Answers b = there.probe(s.pose(pose));
      off.note(here, pose, a, b);
    }
  }
  expect_rounding(off, 48 * poses.size());
}

TEST(V5ScaleByPowersOfTwo, ScalesVoxelsAndForcesExactly) {
  const std::uint64_t seed = testing::seed(74);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const Rig one(ground, tool);
  const std::vector<Pose> poses = touching_poses(ground, 200, random);
  for (const int power : {-20, -7, 1, 20}) {
    const double s = std::ldexp(1.0, power);
    const Rig other(moved(ground, Vec3::Zero(), s), moved(tool, Vec3::Zero(), s), s * kEdge);
    ASSERT_EQ(voxels_of(one.voxmap), voxels_of(other.voxmap)) << power;
    for (const auto& model : one.models)
      model->reset();
    for (const Pose& pose : poses) {
      const Pose large{s * pose.position, pose.orientation};
      for (std::size_t m = 0; m < kModels.size(); ++m) {
        // Depths scale with s, areas with s^2, the lever with s, and latched depths of the stage
        // with s; unit weights do not scale.
        const double f = m >= 2 ? s * s * s : s;
        for (const bool in_the_ring : {false, true}) {
          const contact::ContactResult a =
              in_the_ring ? one.models[m]->render(pose).contact : one.models[m]->probe(pose);
          const contact::ContactResult b =
              in_the_ring ? other.models[m]->render(large).contact : other.models[m]->probe(large);
          ASSERT_EQ(Vec3(f * a.wrench.force), b.wrench.force)
              << model_name(m) << " 2^" << power << ' ' << in_the_ring;
          ASSERT_EQ(Vec3(f * s * a.wrench.torque), b.wrench.torque)
              << model_name(m) << " 2^" << power;
          ASSERT_EQ(s * a.deepest_depth_m, b.deepest_depth_m) << model_name(m) << " 2^" << power;
        }
      }
    }
  }
}

TEST(PermutationOfTriangles, LeavesVoxelsPointsAndForce) {
  const std::uint64_t seed = testing::seed(75);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const Rig here(ground, tool);
  const std::vector<Pose> poses = touching_poses(ground, 200, random);
  Off off;
  for (int n = 0; n < 3; ++n) {
    mesh::TriangleMesh other_ground = ground, other_tool = tool;
    for (mesh::TriangleMesh* mesh : {&other_ground, &other_tool}) {
      for (std::size_t k = mesh->triangles.size(); k > 1; --k)
        std::swap(mesh->triangles[k - 1], mesh->triangles[random() % k]);
      for (auto& t : mesh->triangles)
        std::rotate(t.begin(), t.begin() + static_cast<int>(random() % 3), t.end());
    }
    const Rig there(other_ground, other_tool);
    ASSERT_EQ(voxels_of(here.voxmap), voxels_of(there.voxmap));
    ASSERT_EQ(here.shell.id, there.shell.id);
    for (const Pose& pose : poses)
      off.note(here, pose, here.probe(pose), there.probe(pose));
  }
  expect_rounding(off, 3 * poses.size());
}

TEST(PermutationOfPoints, LeavesTheForce) {
  const std::uint64_t seed = testing::seed(76);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh();
  const pointshell::Pointshell shell = test::exact_shell(tool_mesh(), kEdge);
  const voxmap::Grid grid = voxmap::default_grid(ground, kEdge);
  const Rig here(ground, grid, shell);
  const std::vector<Pose> poses = touching_poses(ground, 200, random);
  Off off;
  for (int n = 0; n < 3; ++n) {
    std::vector<std::size_t> order(shell.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[random() % k]);
    pointshell::Pointshell other = shell;
    const auto permute = [&](auto pointshell::Pointshell::*column) {
      for (std::size_t k = 0; k < order.size(); ++k)
        (other.*column)[k] = (shell.*column)[order[k]];
    };
    for (const auto column :
         {&pointshell::Pointshell::x, &pointshell::Pointshell::y, &pointshell::Pointshell::z,
          &pointshell::Pointshell::nx, &pointshell::Pointshell::ny, &pointshell::Pointshell::nz,
          &pointshell::Pointshell::area_m2, &pointshell::Pointshell::coherence})
      permute(column);
    permute(&pointshell::Pointshell::id);
    const Rig there(ground, grid, other);
    for (const Pose& pose : poses)
      off.note(here, pose, here.probe(pose), there.probe(pose));
  }
  expect_rounding(off, 3 * poses.size());
}

template <class T>
void add(Fnv1a& hash, const T& value) {
  hash.add({reinterpret_cast<const char*>(&value), sizeof value});
}
std::uint64_t hash_of(const voxmap::Voxmap& voxmap) {
  Fnv1a hash;
  for (const auto& [voxel, kind] : voxels_of(voxmap))
    add(hash, voxel), add(hash, kind);
  return hash.value();
}
/// Nodes in and about the mesh's voxels, and a hash over all results.
std::uint64_t hash_of(const voxmap::DistanceField& field, const voxmap::Voxmap& voxmap) {
  Fnv1a hash;
  for (const auto& [voxel, kind] : voxels_of(voxmap))
    for (const int off : {-2, 0, 2})
      add(hash, field.node({voxel.i + off, voxel.j, voxel.k - off}));
  add(hash, field.steepest_gradient()), add(hash, field.stored_nodes());
  return hash.value();
}
std::uint64_t hash_of(const pointshell::Pointshell& shell) {
  Fnv1a hash;
  for (const auto column :
       {&pointshell::Pointshell::x, &pointshell::Pointshell::y, &pointshell::Pointshell::z,
        &pointshell::Pointshell::nx, &pointshell::Pointshell::ny, &pointshell::Pointshell::nz,
        &pointshell::Pointshell::area_m2, &pointshell::Pointshell::coherence})
    for (const auto& value : shell.*column)
      add(hash, value);
  for (const auto& id : shell.id)
    add(hash, id);
  return hash.value();
}

/// The contact runs on one thread: `core` creates none. Builds with several threads must equal
/// builds with one.
TEST(NumberOfThreads, LeavesAllResultsBitIdentical) {
  const std::uint64_t seed = testing::seed(77);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const Rig one(ground, tool);
  const std::vector<Pose> poses = touching_poses(ground, 200, random);
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const Rig many(ground, tool, kEdge, runtime::threaded_for(threads));
    ASSERT_EQ(hash_of(one.voxmap), hash_of(many.voxmap)) << threads;
    ASSERT_EQ(hash_of(one.field, one.voxmap), hash_of(many.field, one.voxmap)) << threads;
    ASSERT_EQ(hash_of(one.shell), hash_of(many.shell)) << threads;
    for (const Pose& pose : poses) {
      const Answers a = one.probe(pose), b = many.probe(pose);
      for (std::size_t m = 0; m < kModels.size(); ++m)
        ASSERT_TRUE(same_bits(a[m], b[m])) << model_name(m) << ' ' << threads;
    }
  }
}

/// Every triangle in four by the middles of its sides, then some of them in three by a point
/// within; all exact.
mesh::TriangleMesh split(const mesh::TriangleMesh& mesh, Random& random) {
  mesh::TriangleMesh fine;
  const auto vertex = [&](const Vec3& x) {
    fine.vertices.push_back(x);
    return static_cast<std::uint32_t>(fine.vertices.size() - 1);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const std::array<Vec3, 3>& part :
         {std::array<Vec3, 3>{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      const std::array<std::uint32_t, 3> n{vertex(part[0]), vertex(part[1]), vertex(part[2])};
      if (random() % 3 != 0) {
        fine.triangles.push_back(n);
        continue;
      }
      const std::uint32_t within = vertex(0.5 * part[0] + 0.25 * part[1] + 0.25 * part[2]);
      for (std::size_t k = 0; k < 3; ++k)
        fine.triangles.push_back({n[k], n[(k + 1) % 3], within});
    }
  }
  return fine;
}

TEST(SplitOfTriangles, LeavesVoxelsPointsAndForce) {
  const std::uint64_t seed = testing::seed(78);
  SCOPED_TRACE(testing::seed_trace(seed));
  Random random(seed);
  const mesh::TriangleMesh ground = ground_mesh(), tool = tool_mesh();
  const Rig coarse(ground, tool);
  Off off;
  for (int n = 0; n < 2; ++n) {
    const mesh::TriangleMesh fine_ground = split(ground, random), fine_tool = split(tool, random);
    ASSERT_GT(fine_ground.triangles.size(), 5 * ground.triangles.size());
    const Rig fine(fine_ground, fine_tool);
    ASSERT_EQ(voxels_of(coarse.voxmap), voxels_of(fine.voxmap));
    ASSERT_EQ(coarse.shell.size(), fine.shell.size());
    for (const Pose& pose : touching_poses(ground, 300, random))
      off.note(coarse, pose, coarse.probe(pose), fine.probe(pose));
  }
  expect_rounding(off, 600);
}

}  // namespace
}  // namespace voxtouch::hard

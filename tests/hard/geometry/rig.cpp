#include "tests/hard/geometry/rig.hpp"

#include <cmath>
#include <cstdio>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::hard {
namespace {

constexpr double kLever = 0.01;

mesh::TriangleMesh stepped(mesh::TriangleMesh mesh) {
  for (Vec3& v : mesh.vertices)
    v = hard::stepped(v, kStep);
  return mesh;
}

}  // namespace

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Quat any_rotation(Random& random) {
  Quat q;
  do
    q.coeffs() = Eigen::Vector4d(uniform(random, -1, 1), uniform(random, -1, 1),
                                 uniform(random, -1, 1), uniform(random, -1, 1));
  while (q.norm() < 0.1);
  return q.normalized();
}

Vec3 stepped(const Vec3& x, double step) { return (x / step).array().round() * step; }

mesh::TriangleMesh ground_mesh() {
  const Pose tilt{Vec3(0.001, -0.002, 0.003),
                  Quat(Eigen::AngleAxisd(0.43, Vec3(3, 1, 2).normalized()))};
  mesh::TriangleMesh ball = test::sphere_mesh(0.021, 2);
  for (Vec3& v : ball.vertices)
    v += Vec3(0.009, 0.004, 0.013);
  return stepped(test::joined(test::box_mesh(Vec3(0.061, 0.047, 0.023), tilt), ball));
}

mesh::TriangleMesh tool_mesh() { return stepped(test::Ball(kBallRadius, 2).mesh); }

std::vector<std::pair<voxmap::VoxelIndex, voxmap::VoxelKind>> voxels_of(
    const voxmap::Voxmap& voxmap) {
  std::vector<std::pair<voxmap::VoxelIndex, voxmap::VoxelKind>> voxels;
  voxmap.for_each_occupied(
      [&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) { voxels.emplace_back(v, kind); });
  return voxels;
}

Rig::Rig(const mesh::TriangleMesh& ground, const voxmap::Grid& grid, pointshell::Pointshell tool,
         const ParallelFor& loop)
    : voxmap(voxmap::voxelise(ground, grid, loop)),
      field(voxmap::build_distance_field(ground, voxmap, {}, loop)),
      shell(std::move(tool)),
      scale(grid.edge / kEdge) {
  make_models();
}

Rig::Rig(const mesh::TriangleMesh& ground, const mesh::TriangleMesh& tool, double edge,
         const ParallelFor& loop)
    : Rig(ground, voxmap::default_grid(ground, edge), test::exact_shell(tool, edge, loop), loop) {}

void Rig::make_models() {
  for (std::size_t m = 0; m < kModels.size(); ++m) {
    const bool by_area = m == kField;
    if (m == kField && !field.has_inside())
      continue;
    const contact::ContactParameters law{
        by_area ? kPerVolume : kPerPoint,
        by_area ? contact::PointWeights::kArea : contact::PointWeights::kOne};
    models[m] = std::make_unique<contact::ContactRenderer>(voxmap, shell, kModels[m], law, &field);
  }
}

Answers Rig::probe(const Pose& pose) const {
  Answers answers;
  for (std::size_t m = 0; m < kModels.size(); ++m)
    if (models[m])
      answers[m] = models[m]->probe(pose);
  return answers;
}

std::vector<Pose> touching_poses(const mesh::TriangleMesh& ground, std::size_t count,
                                 Random& random) {
  const test::Ball ball(kBallRadius, 0);
  std::vector<Pose> poses;
  while (poses.size() < count) {
    const std::size_t t = random() % ground.triangles.size();
    const Vec3 &a = ground.corner(t, 0), &b = ground.corner(t, 1), &c = ground.corner(t, 2);
    const double s = uniform(random, 0.05, 0.9), r = uniform(random, 0.05, 0.95 - s);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    const double depth = uniform(random, -0.5, 1.5) * kEdge;
    const Pose pose = ball.posed(a + s * (b - a) + r * (c - a) + (kBallRadius - depth) * normal,
                                 any_rotation(random));
    poses.push_back({stepped(pose.position, 0x1p-26), pose.orientation});
  }
  return poses;
}

double pull(const Rig& rig, const Pose& pose, std::size_t model) {
  if (!rig.models[model])
    return 0.0;
  rig.models[model]->probe(pose);
  double weights = 0.0;
  for (const contact::Hits* list :
       {&rig.models[model]->hits().surface, &rig.models[model]->hits().interior})
    for (const contact::Hit& hit : *list)
      weights += hit.weight;
  return weights * (model == kField ? kPerVolume : kPerPoint);
}

bool same_bits(const contact::ContactResult& a, const contact::ContactResult& b) {
  return a.wrench.force == b.wrench.force && a.wrench.torque == b.wrench.torque &&
         a.mean_normal == b.mean_normal && a.coherence == b.coherence &&
         a.surface_hits == b.surface_hits && a.interior_hits == b.interior_hits &&
         a.deepest_depth_m == b.deepest_depth_m && a.stiffness == b.stiffness &&
         a.fallback == b.fallback && a.saturated == b.saturated;
}

std::string_view model_name(std::size_t model) { return contact::name_of(kModels[model]); }

void Off::note(const Rig& rig, const Pose& pose, const Answers& expected, const Answers& got) {
  bool touches = false;
  for (std::size_t m = 0; m < kModels.size(); ++m) {
    ASSERT_EQ(expected[m].surface_hits, got[m].surface_hits) << model_name(m);
    ASSERT_EQ(expected[m].interior_hits, got[m].interior_hits) << model_name(m);
    const double weight = pull(rig, pose, m);
    if (!(weight > 0.0))
      continue;
    const double force = (expected[m].wrench.force - got[m].wrench.force).norm();
    const double torque = (expected[m].wrench.torque - got[m].wrench.torque).norm() / kLever;
    metres[m] = std::max(metres[m], std::max(force, torque) / weight);
    touches = touches || !expected[m].wrench.zero();
  }
  touching += touches;
}

std::string Off::text() const {
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu poses with force; off by: original %.2g, adapted %.2g, field %.2g m of depth",
                touching, metres[0], metres[1], metres[2]);
  return text;
}

}  // namespace voxtouch::hard

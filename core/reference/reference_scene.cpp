#include "core/reference/reference_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "core/reference/chord_error.hpp"
#include "core/reference/dynamic_mesh.hpp"
#include "core/reference/posed_mesh.hpp"

namespace voxtouch::reference {
namespace {

constexpr double kUniqueAngleRad =
    5.0 * std::numbers::pi / 180.0;  ///< Largest angle between the patch's mean direction and that
                                     ///< of its centre.
constexpr double kThickRatio =
    0.25;  ///< Of an edge: largest difference of depth and distance inside for a single thick face.
constexpr double kKeepSide =
    0.9;  ///< of the centre's distance: a smaller step cannot cross the surface

constexpr int kRimPoints = 6;

/// The static objects as a union.
struct Union {
  const std::vector<PosedMesh>& objects;

  SignedPoint mesh_signed_distance(const Vec3& x) const {
    SignedPoint best;
    least(
        x, [&](std::size_t i) { return objects[i].mesh_signed_distance(x); },
        [](const SignedPoint& one) { return one.distance_m; }, best);
    return best;
  }
  Vec3 nearest(const Vec3& x) const {
    Vec3 best = x;
    least(
        x, [&](std::size_t i) { return objects[i].nearest(x); },
        [&](const Vec3& one) { return (x - one).norm(); }, best);
    return best;
  }
  /// The answer of the nearest object; for equal distances that of the first.
  template <class Answer, class Ask, class Distance>
  void least(const Vec3& x, Ask ask, Distance distance, Answer& best) const {
    std::size_t which = objects.size();
    double least_m = std::numeric_limits<double>::infinity();
    visit_nearest_first(objects, x, 0.0, [&](std::size_t i) {
      Answer answer = ask(i);
      const double own_m = distance(answer);
      if (which == objects.size() || own_m < least_m || (own_m == least_m && i < which))
        best = std::move(answer), which = i, least_m = own_m;
      return own_m;
    });
  }
  /// Unit vector from the nearest surface point to `x`, reversed if `inside`.
  Vec3 direction(const Vec3& x, bool inside) const {
    return (inside ? -1.0 : 1.0) * (x - nearest(x)).normalized();
  }
};

/// See ReferenceScene: whether `up`, found at `centre`, represents the whole patch.
bool stands_for_patch(const Union& all, const Vec3& centre, double distance, const Vec3& up,
                      double reach, double lift) {
  const bool inside = distance < 0;
  const double limit = kKeepSide * std::abs(distance);
  const Vec3 side = up.unitOrthogonal(), other = up.cross(side);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& step : {side, Vec3(-side), other, Vec3(-other)})
    mean += all.direction(centre + std::min(reach, limit) * step, inside);
  if (angle_between(mean, up) > kUniqueAngleRad)
    return false;
  return angle_between(all.direction(centre + std::min(lift, limit) * up, inside), up) <=
         kUniqueAngleRad;
}

}  // namespace

struct ReferenceScene::Parts {
  double edge = 0.0, chord = 0.0, tool_reach = 0.0;
  bool all_closed = true;
  std::vector<PosedMesh> statics;
  std::vector<std::pair<std::size_t, Motion>> moving;  ///< the moving objects and their motions
  std::optional<scene::SpherePrimitive> sphere;        ///< in T
  std::optional<DynamicMesh> mesh;

  GapResult sphere_gap(const Vec3& centre) const;
  void add_depth(const SignedPoint& at_centre, const Vec3& centre, GapResult& gap) const;
  double cap_inside(const Union& all, const Vec3& centre, const GapResult& gap) const;
};

ReferenceScene::ReferenceScene(const scene::Scene& scene) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  if (scene.static_meshes.empty() || !(scene.voxel_size_m > 0))
    throw std::runtime_error(scene.file.string() +
                             ": the reference needs a static mesh and a voxel size above zero");
  p.edge = scene.voxel_size_m;
  double static_chord = 0.0;
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    if (spec.object > 0 && scene.objects.at(spec.object - 1).moves)
      p.moving.emplace_back(p.statics.size(), *scene.objects[spec.object - 1].moves);
    p.statics.emplace_back(spec);
    p.all_closed = p.all_closed && p.statics.back().closed();
    static_chord = std::max(static_chord, p.statics.back().chord_error_m());
  }
  const scene::MeshSpec& tool = scene.dynamic_mesh;
  const auto* declared = tool.primitives.size() == 1
                             ? std::get_if<scene::SpherePrimitive>(&tool.primitives.front())
                             : nullptr;
  if (declared != nullptr) {
    const ReferenceMesh mesh = read_reference_mesh(tool);
    p.chord = static_chord + chord_error(mesh, MeshDistance(mesh), tool.primitives).value_m();
    p.sphere = scene::SpherePrimitive{tool.pose * declared->centre, declared->radius_m};
  } else {
    p.chord = static_chord;
    p.mesh.emplace(tool);
  }
  for (const Vec3& vertex : read_reference_mesh(tool).vertices)
    p.tool_reach = std::max(p.tool_reach, (tool.pose * vertex).norm());
  if (p.sphere)
    p.tool_reach = std::max(p.tool_reach, p.sphere->centre.norm() + p.sphere->radius_m);
}
ReferenceScene::~ReferenceScene() = default;
ReferenceScene::ReferenceScene(ReferenceScene&&) noexcept = default;
ReferenceScene& ReferenceScene::operator=(ReferenceScene&&) noexcept = default;

void ReferenceScene::move_to(double time_s) noexcept {
  for (const auto& [which, motion] : parts_->moving)
    parts_->statics[which].move_by(motion_at(motion, time_s).position);
}

double ReferenceScene::chord_error_m() const noexcept { return parts_->chord; }

Vec3 ReferenceScene::nearest(const Vec3& x) const { return Union{parts_->statics}.nearest(x); }

double ReferenceScene::tool_reach_m() const noexcept { return parts_->tool_reach; }

bool ReferenceScene::inside_known() const noexcept { return parts_->all_closed; }

GapResult ReferenceScene::gap(const Pose& pose_WT) const {
  if (!pose_WT.finite())
    return {};
  const Parts& p = *parts_;
  GapResult gap =
      p.sphere ? p.sphere_gap(pose_WT * p.sphere->centre) : p.mesh->gap(p.statics, pose_WT);
  gap.inside_known = p.all_closed;
  return gap;
}

double ReferenceScene::apart_m(const Pose& pose_WT) const {
  const Parts& p = *parts_;
  if (!pose_WT.finite())
    return std::numeric_limits<double>::quiet_NaN();
  if (!p.sphere)
    return p.mesh->apart_m(p.statics, pose_WT);
  const Vec3 centre = pose_WT * p.sphere->centre;
  PosedMesh::Answer best;
  Union{p.statics}.least(
      centre, [&](std::size_t i) { return p.statics[i].signed_distance(centre); },
      [](const PosedMesh::Answer& one) { return one.signed_point.distance_m; }, best);
  return best.signed_point.distance_m - p.sphere->radius_m;
}

GapResult ReferenceScene::Parts::sphere_gap(const Vec3& centre) const {
  GapResult gap;
  gap.sphere_radius_m = sphere->radius_m;
  gap.self_error_m = 0.0;
  PosedMesh::Answer best;
  Union{statics}.least(
      centre,
      [&](std::size_t i) {
        PosedMesh::Answer answer = statics[i].signed_distance(centre);
        gap.self_error_m = std::max(gap.self_error_m, answer.check_error_m);
        return answer;
      },
      [](const PosedMesh::Answer& one) { return one.signed_point.distance_m; }, best);
  gap.self_check = gap.self_error_m <= 0.0;
  gap.method = best.closed_form ? GapMethod::kClosedForm : GapMethod::kSphereMesh;
  gap.gap_m = best.signed_point.distance_m - sphere->radius_m;
  gap.nearest_static = best.signed_point.nearest;
  add_depth(best.signed_point, centre, gap);
  return gap;
}

double ReferenceScene::Parts::cap_inside(const Union& all, const Vec3& centre,
                                         const GapResult& gap) const {
  const double radius = sphere->radius_m, reach = std::sqrt(3.0) * edge;
  if (gap.inside_depth_m <= 0 || reach >= radius)
    return 0.0;
  const double angle = 2.0 * std::asin(0.5 * reach / radius);
  const Vec3 side = gap.direction.unitOrthogonal(), other = gap.direction.cross(side);
  double least = gap.inside_depth_m;
  for (int k = 0; k < kRimPoints && least > 0; ++k) {
    const double around = 2.0 * std::numbers::pi * k / kRimPoints;
    const Vec3 out = std::sin(angle) * (std::cos(around) * side + std::sin(around) * other) -
                     std::cos(angle) * gap.direction;
    least = std::min(least, -all.mesh_signed_distance(centre + radius * out).distance_m);
  }
  return std::max(0.0, least);
}

void ReferenceScene::Parts::add_depth(const SignedPoint& at_centre, const Vec3& centre,
                                      GapResult& gap) const {
  const double distance = at_centre.distance_m, depth = std::max(0.0, -gap.gap_m);
  gap.nearest_dynamic = centre;
  if (std::abs(distance) < kThickRatio * edge)
    return;  // the centre lies on the surface: the direction is undefined
  const Union all{statics};
  gap.direction = (distance < 0 ? -1.0 : 1.0) * (centre - at_centre.nearest).normalized();
  gap.nearest_dynamic = centre - sphere->radius_m * gap.direction;
  if (depth > 0)
    gap.inside_depth_m =
        std::clamp(-all.mesh_signed_distance(gap.nearest_dynamic).distance_m, 0.0, depth);
  gap.cap_inside_depth_m = cap_inside(all, centre, gap);
  gap.depth_exact = depth - gap.inside_depth_m <= kThickRatio * edge + chord;
  const double layer = std::sqrt(3.0) * edge -
                       gap.gap_m;  // shell points up to this far above the lowest one may collide
  gap.unique_face = layer > 0 && stands_for_patch(all, centre, distance, gap.direction,
                                                  std::sqrt(2.0 * sphere->radius_m * layer),
                                                  0.5 * layer + kThickRatio * edge);
}

}  // namespace voxtouch::reference

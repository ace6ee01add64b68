#include "core/rendering/exact_tool.hpp"

#include <algorithm>

namespace voxtouch::rendering {
namespace {

/// Pairs that all lists of a kind hold together, over all bodies; and of one body at least.
constexpr std::size_t kPairs = 1 << 16, kPairsOfOne = 1 << 13;

std::vector<const exact::ObjectBody*> pointers_to(std::span<const exact::ObjectBody> bodies) {
  std::vector<const exact::ObjectBody*> pointers;
  for (const exact::ObjectBody& body : bodies)
    pointers.push_back(&body);
  return pointers;
}

contact::PoseStatus status_of(exact::PoseStatus status) noexcept {
  switch (status) {
    case exact::PoseStatus::kUsable:
      return contact::PoseStatus::kUsable;
    case exact::PoseStatus::kNotAPose:
      return contact::PoseStatus::kNotAPose;
    case exact::PoseStatus::kOutOfRange:
      break;
  }
  return contact::PoseStatus::kOutOfRange;
}

bool same(const Pose& a, const Pose& b) noexcept {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

}  // namespace

ExactTool::ExactTool(const ExactBodies& bodies, std::size_t objects, double lever_m)
    : bodies_(bodies),
      tool_(bodies.tool(), pointers_to(bodies.bodies()),
            {.lever_m = bodies.scale() * lever_m,
             .pair_capacity = std::max(kPairsOfOne, kPairs / bodies.bodies().size())}),
      poses_(bodies.bodies().size()),
      forces_(objects) {}

Pose ExactTool::to_bodies(const Pose& pose) const noexcept {
  return {bodies_.scale() * (pose.position - bodies_.origin()), pose.orientation};
}

Vec3 ExactTool::to_world(const Vec3& position) const noexcept {
  return position / bodies_.scale() + bodies_.origin();
}

void ExactTool::put(std::span<const Vec3> displacements) noexcept {
  for (std::size_t n = 0; n < poses_.size(); ++n)
    poses_[n].position = bodies_.scale() * displacements[bodies_.leader(n)];
}

contact::VirtualToolFrame ExactTool::frame(const contact::HandSample& sample,
                                           std::span<const Vec3> displacements) noexcept {
  put(displacements);
  const Pose hand = to_bodies(sample.pose);
  const exact::VirtualToolFrame found =
      tool_.frame({hand, sample.period_s, sample.friction}, poses_);
  contact::VirtualToolFrame out;
  out.tool = same(found.tool, hand) ? sample.pose
                                    : Pose{to_world(found.tool.position), found.tool.orientation};
  report(found, out);
  return out;
}

void ExactTool::report(const exact::VirtualToolFrame& found,
                       contact::VirtualToolFrame& out) noexcept {
  const double scale = bodies_.scale();
  out.shift = found.shift / scale;
  out.turn = found.rotation;
  out.lever_m = found.lever_m / scale;
  out.fraction = found.ratio;
  out.displayed = found.displayed;
  out.residual_m = found.residual_m / scale;
  out.contact_point = to_world(found.contact_point);
  out.contact_normal = found.contact_normal;
  out.contact_object = static_cast<std::uint32_t>(bodies_.objects()[found.contact_owner]);
  out.surface_hits = out.rows = found.rows;
  out.points_tested = found.pairs_seen;
  out.queries = found.queries;
  out.iterations = found.iterations;
  out.pose_status = status_of(found.pose_status);
  out.constrained = found.constrained;
  out.not_initialised = found.not_initialised;
  const bool free = found.not_converged && !found.constrained;
  out.not_converged =
      !out.not_initialised && (free || found.cut_short || found.object_delay_m > 0.0);
  out.moved_too_far = found.passed_through;
  std::fill(forces_.begin(), forces_.end(), Wrench{});
  const std::span<const Wrench> by_owner = tool_.contact_forces();
  for (std::size_t n = 0; n < by_owner.size(); ++n) {
    Wrench& sum = forces_[bodies_.objects()[n]];
    sum.force += by_owner[n].force / scale;
    sum.torque += by_owner[n].torque / (scale * scale);
  }
}

}  // namespace voxtouch::rendering

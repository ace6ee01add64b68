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

exact::VirtualToolFrame ExactTool::frame(const exact::HandSample& sample,
                                         std::span<const Vec3> displacements) noexcept {
  for (std::size_t n = 0; n < poses_.size(); ++n)
    poses_[n].position = bodies_.scale() * displacements[bodies_.leader(n)];
  const Pose hand = to_bodies(sample.pose);
  exact::VirtualToolFrame frame = tool_.frame({hand, sample.period_s, sample.friction}, poses_);
  frame.tool = same(frame.tool, hand) ? sample.pose
                                      : Pose{to_world(frame.tool.position), frame.tool.orientation};
  const double scale = bodies_.scale();
  frame.shift /= scale;
  frame.lever_m /= scale;
  frame.residual_m /= scale;
  frame.object_delay_m /= scale;
  frame.contact_point = to_world(frame.contact_point);
  frame.contact_owner = static_cast<std::uint32_t>(bodies_.objects()[frame.contact_owner]);
  take_forces();
  return frame;
}

void ExactTool::take_forces() noexcept {
  const double scale = bodies_.scale();
  std::fill(forces_.begin(), forces_.end(), Wrench{});
  const std::span<const Wrench> by_owner = tool_.contact_forces();
  for (std::size_t n = 0; n < by_owner.size(); ++n) {
    Wrench& sum = forces_[bodies_.objects()[n]];
    sum.force += by_owner[n].force / scale;
    sum.torque += by_owner[n].torque / (scale * scale);
  }
}

}  // namespace voxtouch::rendering

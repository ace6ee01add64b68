#include "core/accuracy/true_tools.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

#include "core/reference/god_ball.hpp"
#include "core/reference/reference_mesh.hpp"

namespace voxtouch::accuracy {
namespace {

/// Radius of a tool that is declared as one sphere about its origin [m]; 0 for any other.
double declared_ball_m(const scene::Scene& scene) noexcept {
  const scene::MeshSpec& tool = scene.dynamic_mesh;
  const auto* ball = tool.primitives.size() == 1
                         ? std::get_if<scene::SpherePrimitive>(&tool.primitives.front())
                         : nullptr;
  return ball != nullptr && (tool.pose * ball->centre).norm() <= 1e-9 ? ball->radius_m : 0.0;
}

std::unique_ptr<reference::GodObject> make_god_object(const scene::Scene& scene) {
  const reference::ReferenceMesh tool = reference::joined_mesh(
      {{reference::read_reference_mesh(scene.dynamic_mesh), scene.dynamic_mesh.pose}});
  if (!tool.closed)
    throw std::runtime_error(scene.dynamic_mesh.path.string() +
                             ": the tool's mesh is open; the reference of a virtual tool needs a "
                             "closed one. Close the mesh, or remove virtual_tool from --models");
  std::vector<std::pair<reference::ReferenceMesh, Pose>> objects;
  for (const scene::MeshSpec& spec : scene.static_meshes)
    objects.emplace_back(reference::read_reference_mesh(spec), spec.pose);
  return std::make_unique<reference::GodObject>(tool, reference::joined_mesh(objects),
                                                scene.lever_m.value_or(0.0));
}

}  // namespace

ToolTruth tool_truth(const scene::Scene& scene) noexcept {
  return declared_ball_m(scene) > 0.0 ? ToolTruth::kBall : ToolTruth::kGodObject;
}

TrueTools::TrueTools(const scene::Scene& scene, const reference::ReferenceScene& reference)
    : reference_(reference),
      radius_m_(declared_ball_m(scene)) {
  if (!(radius_m_ > 0.0))
    god_object_ = make_god_object(scene);
}

std::optional<Wrench> TrueTools::at(const ContactPlace& place, double depth_m) {
  const Pose hand = place.at(depth_m);
  if (!god_object_) {
    const Vec3 centre =
        reference::drawn_ball(reference_, radius_m_, place.touch.position, hand.position);
    return Wrench{centre - hand.position, Vec3::Zero()};
  }
  // The path to the touch is free. The first start that is apart from the scene is used.
  for (const double back : {0.02, 0.002, 0.0002}) {
    const auto rest = god_object_->led(place.at(-back * god_object_->tool_reach_m()), hand);
    if (rest && rest->settled && rest->apart_m > 0.0)
      return rest->wrench();
    if (rest)
      break;
  }
  return std::nullopt;
}

std::vector<Wrench> TrueTools::at(const std::vector<ContactPlace>& places, std::size_t count,
                                  double depth_m,
                                  const std::function<void(double fraction)>& progress) {
  std::vector<std::optional<Wrench>>& known = known_[depth_m];
  const std::size_t requested = std::min(count, places.size()), before = known.size();
  while (known.size() < requested) {
    if (progress)
      progress(static_cast<double>(known.size() - before) /
               static_cast<double>(requested - before));
    known.push_back(at(places[known.size()], depth_m));
  }
  std::vector<Wrench> out;
  for (std::size_t n = 0; n < requested; ++n)
    out.push_back(known[n].value_or(Wrench{}));
  return out;
}

std::size_t TrueTools::unknown(const std::vector<ContactPlace>& places, std::size_t count,
                               double depth_m) const {
  const auto known = known_.find(depth_m);
  const std::size_t requested = std::min(count, places.size()),
                    has = known == known_.end() ? 0 : known->second.size();
  return requested > has ? requested - has : 0;
}

std::uint32_t TrueTools::unsettled(double depth_m) const {
  const auto known = known_.find(depth_m);
  if (known == known_.end())
    return 0;
  return static_cast<std::uint32_t>(
      std::count_if(known->second.begin(), known->second.end(),
                    [](const std::optional<Wrench>& at) { return !at; }));
}

}  // namespace voxtouch::accuracy

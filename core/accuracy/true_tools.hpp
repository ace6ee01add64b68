#pragma once
/// The true wrenches of a virtual tool at the places of a measurement, each worked out once.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/contact_places.hpp"
#include "core/reference/god_object.hpp"
#include "core/reference/reference_scene.hpp"

namespace voxtouch::accuracy {

/// Per unit of the spring: from the hand to the tool that follows it outside. A tool that is
/// declared as one sphere about its origin is that exact ball (god_ball.hpp). Any other closed tool
/// is a god-object on the meshes' triangles (god_object.hpp).
class TrueTools {
 public:
  /// Reads the scene's mesh files itself. Throws std::runtime_error, a sentence, for an open tool.
  /// `reference` must outlive this.
  TrueTools(const scene::Scene& scene, const reference::ReferenceScene& reference);

  ToolTruth kind() const noexcept { return god_object_ ? ToolTruth::kGodObject : ToolTruth::kBall; }

  /// Wrenches at the first `count` of `places`, the hand `depth_m` in; zero if the reference found
  /// no equilibrium outside. The same places in every call. `progress` receives the fraction of new
  /// ones.
  std::vector<Wrench> at(const std::vector<ContactPlace>& places, std::size_t count, double depth_m,
                         const std::function<void(double fraction)>& progress = {});
  /// How many of these have not been worked out yet.
  std::size_t unknown(const std::vector<ContactPlace>& places, std::size_t count,
                      double depth_m) const;
  /// Evaluated places at this depth at which the reference found no equilibrium outside.
  std::uint32_t unsettled(double depth_m) const;

 private:
  std::optional<Wrench> at(const ContactPlace& place, double depth_m);

  const reference::ReferenceScene& reference_;
  double radius_m_ = 0.0;  ///< of the ball
  std::unique_ptr<reference::GodObject> god_object_;
  /// By depth, for the first places; none without an equilibrium.
  std::map<double, std::vector<std::optional<Wrench>>> known_;
};

/// The reference of a virtual tool for this scene; reads no mesh.
ToolTruth tool_truth(const scene::Scene& scene) noexcept;

}  // namespace voxtouch::accuracy

#pragma once
/// Computes the tool's points in contact and slices through the voxels for the page. The ring
/// publishes neither.
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/rendering/build.hpp"
#include "core/scene/scene.hpp"
#include "nodes/view/voxel_slice.hpp"

namespace voxtouch::view {

/// Builds a copy of the scene and evaluates its contact models at the newest requested pose, in
/// threads of the lowest priority. Used by one thread. No call blocks, except the destructor, which
/// waits for the running thread.
class ContactPoints {
 public:
  /// Sets the scene to build.
  void set_scene(const scene::Scene& scene);
  /// Requests the points in contact with the tool at `object` in W and moving objects at
  /// `scene_time_s`.
  void request(const Pose& object, double scene_time_s);
  /// Requests a slice; the newest request replaces the others.
  void request(const SliceRequest& request);
  /// Takes results and starts the next request. Call it often.
  void poll();
  /// Returns each slice once; see slice_of.
  std::optional<nlohmann::json> take_slice();
  /// Points of the last finished request, in W [m], at most kMaxPoints, evenly selected; empty
  /// without a scene.
  const std::optional<std::vector<Vec3>>& points() const noexcept { return points_; }
  /// {"type": "shell", "points": [x, y, z, ...]}: the tool's pointshell in T [m], at most
  /// kMaxShellPoints, evenly chosen. Null until the scene is built.
  const nlohmann::json& shell() const noexcept { return shell_; }
  /// The reason for missing points, or empty.
  const std::string& missing_reason() const noexcept { return missing_reason_; }

  static constexpr std::size_t kMaxPoints = 400, kMaxShellPoints = 2000;

 private:
  struct PoseRequest {
    Pose object;
    double scene_time_s = 0.0;
  };
  struct Result {
    std::optional<std::vector<Vec3>> points;
    std::optional<nlohmann::json> slice;
  };

  std::optional<scene::Scene> scene_;  ///< to build
  std::optional<PoseRequest> pose_request_;
  std::optional<SliceRequest> slice_request_;
  std::optional<nlohmann::json> slice_;
  nlohmann::json shell_;
  std::optional<std::vector<Vec3>> points_;
  std::string missing_reason_ = "the scene file is not available";
  std::unique_ptr<rendering::BuiltScene> built_;  ///< owned by `query_` while that runs
  std::future<std::unique_ptr<rendering::BuiltScene>> building_;
  std::future<Result> query_;
};

}  // namespace voxtouch::view

#pragma once
/// The tool's points in contact, and planes through the voxels, found anew here: the ring carries
/// neither, and is not asked for more.
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

/// Builds the scene once more and asks its contact models about poses, the newest alone, in threads
/// of the lowest priority. One thread calls it, and none of its calls waits; its end waits for what
/// is under way.
class ContactPoints {
 public:
  /// Another scene; built when its turn comes.
  void scene_is(const scene::Scene& scene);
  /// Which points touch with the tool at `object` in W, where moving objects are at `scene_time_s`.
  void ask(const Pose& object, double scene_time_s);
  /// A plane of voxels, likewise the newest question alone.
  void ask(const SliceQuestion& question);
  /// Takes what has been found, and begins what has been asked for since. To be called often.
  void look();
  /// The last one answered, once; see slice_of.
  std::optional<nlohmann::json> take_slice();
  /// In W [m], of the pose that was answered last; at most kMaxPoints, evenly chosen. Nothing where
  /// there is no scene to ask.
  const std::optional<std::vector<Vec3>>& points() const noexcept { return points_; }
  /// {"type": "shell", "points": [x, y, z, ...]}: the tool's pointshell in T [m], at most
  /// kMaxShellPoints, evenly chosen. Null until the scene is built.
  const nlohmann::json& shell() const noexcept { return shell_; }
  /// Why there are none; empty: there are.
  const std::string& refusal() const noexcept { return refusal_; }

  static constexpr std::size_t kMaxPoints = 400, kMaxShellPoints = 2000;

 private:
  struct Question {
    Pose object;
    double scene_time_s = 0.0;
  };
  struct Found {
    std::optional<std::vector<Vec3>> points;
    std::optional<nlohmann::json> slice;
  };

  std::optional<scene::Scene> scene_;  ///< to be built
  std::optional<Question> question_;
  std::optional<SliceQuestion> slice_question_;
  std::optional<nlohmann::json> slice_;
  nlohmann::json shell_;
  std::optional<std::vector<Vec3>> points_;
  std::string refusal_ = "the scene file is not available";
  std::unique_ptr<rendering::BuiltScene> built_;  ///< while something is found: of that thread
  std::future<std::unique_ptr<rendering::BuiltScene>> building_;
  std::future<Found> finding_;
};

}  // namespace voxtouch::view

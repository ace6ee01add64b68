#pragma once
/// The tool's points in contact, and planes through the voxels, found anew here: the ring carries neither, and is not asked for more.
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"
#include "nodes/view/voxel_slice.hpp"

namespace voxtouch::view {

/// A thread of low priority that builds the scene once more and asks its contact models about poses, the newest alone.
class ContactPoints {
 public:
  ContactPoints();
  ~ContactPoints();
  ContactPoints(const ContactPoints&) = delete;
  ContactPoints& operator=(const ContactPoints&) = delete;

  /// Another scene; built when its turn comes.
  void scene_is(const scene::Scene& scene);
  void forget();
  void ask(const Pose& object, double scene_time_s);
  /// A plane of voxels, likewise the newest question alone.
  void ask(const SliceQuestion& question);
  /// The last one answered, once; see slice_of.
  std::optional<nlohmann::json> take_slice();
  /// In W [m], of the pose that was answered last; at most kMost, evenly chosen. Nothing where there is no scene to ask.
  std::optional<std::vector<Vec3>> points() const;
  /// Why there are none; empty: there are.
  std::string why_not() const;

  static constexpr std::size_t kMost = 400;

 private:
  struct Question {
    Pose object;
    double scene_time_s = 0.0;
  };
  void run();

  mutable std::mutex mutex_;
  std::condition_variable something_;
  std::optional<scene::Scene> scene_;         ///< to be built
  std::optional<Question> question_;
  std::optional<SliceQuestion> slice_question_;
  std::optional<nlohmann::json> slice_;
  std::optional<std::vector<Vec3>> points_;
  std::string why_not_ = "the scene's file is not at hand";
  std::uint64_t wanted_ = 0;  ///< counts scenes: answers of an old one are dropped
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace voxtouch::view

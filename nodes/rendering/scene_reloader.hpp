#pragma once
/// Builds a scene next to the loop, and owns all built scenes.
#include <atomic>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/rendering/build.hpp"
#include "nodes/rendering/pending_changes.hpp"

namespace voxtouch::rendering_node {

class SceneReloader {
 public:
  struct Result {
    scene::Scene scene;
    std::unique_ptr<rendering::BuiltScene> built;
    std::string refusal;  ///< empty: the scene is built
  };

  SceneReloader(std::filesystem::path file, std::unique_ptr<rendering::BuiltScene> first)
      : file_(std::move(file)) {
    keep(std::move(first));
  }
  ~SceneReloader() { stop_.store(true); }
  SceneReloader(const SceneReloader&) = delete;
  SceneReloader& operator=(const SceneReloader&) = delete;

  /// Starts a build in a thread of ordinary priority. `running` must not change until the result is
  /// taken. `voxel_size_m` 0 and `model` empty select the values of the file.
  void start(ChangeRequest request, const scene::Scene& running, double voxel_size_m,
             std::string model);
  /// The request whose scene is being built or waits for the loop.
  const std::optional<ChangeRequest>& request() const noexcept { return request_; }
  bool has_result() const;
  Result take() { return result_.get(); }
  void finish() { request_.reset(); }

  rendering::BuiltScene* keep(std::unique_ptr<rendering::BuiltScene> scene);
  void release(const rendering::BuiltScene* scene);

 private:
  Result build(const scene::Scene& running, double voxel_size_m, const std::string& model) const;

  const std::filesystem::path file_;
  /// Rendered, fading or waiting for the loop.
  std::vector<std::unique_ptr<rendering::BuiltScene>> scenes_;
  std::optional<ChangeRequest> request_;
  std::atomic<bool> stop_{false};
  std::future<Result> result_;
};

}  // namespace voxtouch::rendering_node

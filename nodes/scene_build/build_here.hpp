#pragma once
/// Builds a scene in a program: each mesh is read in a separate process, all processors are used,
/// and progress is reported.
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/rendering/build.hpp"
#include "nodes/runtime/parallel_for.hpp"

namespace voxtouch::scene_build {

struct BuildHow {
  std::string who;  ///< begins each printed line
  std::optional<contact::ContactModelKind> model = {};
  ParallelFor loop = runtime::threaded_for();
  std::function<void()> go_on =
      {};  ///< called before each step, from any thread; throws to end the build
  bool reports_progress = true;
};

/// Throws as rendering::build_scene and `go_on`.
std::unique_ptr<rendering::BuiltScene> build_here(const scene::Scene& scene, const BuildHow& how);

}  // namespace voxtouch::scene_build

#pragma once
/// The rendering walks a scene's motions at 1 kHz and a ContactValidator checks every 20th frame,
/// as the validator node does.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/reference/contact_validator.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::test {

/// Consecutive poses of the tool in W, and the reference's results for the checked ones.
struct Walk {
  std::string name;
  std::vector<Pose> poses;
  std::size_t every = 20;  ///< which poses are checked
  bool jumps = false;  ///< the poses are no motion: the rendering forgets the last one before each
  std::vector<reference::GapResult> gaps;  ///< of poses 0, every, 2 every, ...

  /// Checked poses that are in contact by the reference's word.
  std::size_t contacts() const;
};

/// Perturbation of a motion: up to 1.5 voxel edges per axis (3 mm at an edge of 2 mm), and any
/// rotation.
struct Perturbation {
  Vec3 offset = Vec3::Zero();
  Quat turn = Quat::Identity();
};

/// Fault of a rendering; none by default.
struct Fault {
  std::string name = "none";
  Vec3 grid_shift = Vec3::Zero();  ///< displacement of the voxmap from its right place [m]
  contact::ContactRenderer* renderer = nullptr;  ///< replaces the scene's renderer
  /// Changes the report of frame `n`; a fresh one for each walk, since it may remember.
  using Tamper = std::function<void(std::size_t n, reference::ReportedContact& report)>;
  std::function<Tamper()> tamper = {};
};

struct Outcome {
  reference::ValidationCounts counts;
  std::string first;  ///< the first disagreement, for people

  Outcome& operator+=(const Outcome& other);
};

/// One scene with its rendering, its reference and its walks.
class Ground {
 public:
  /// `scene` is the reference's. `tool_to_sphere` is added to the dynamic mesh's position in T: a
  /// sphere on a handle. The tool's poses are such that the sphere follows the motions.
  explicit Ground(scene::Scene scene, const Vec3& tool_to_sphere = Vec3::Zero());

  const scene::Scene& scene() const noexcept { return scene_; }
  rendering::BuiltScene& built() noexcept { return *built_; }
  reference::ValidatorSettings settings() const;

  /// The scene's motion `name` for 10 s, displaced by `perturbation`.
  Walk motion(const std::string& name, const Perturbation& perturbation = {}) const;
  /// `count` poses near those of the motion, in no order.
  Walk scattered(const std::string& name, std::size_t count, unsigned seed) const;
  /// The motions hit, slide and circle, each unchanged, displaced, and scattered; and free.
  std::vector<Walk> walks() const;

  Outcome judged(const Walk& walk, const Fault& fault = {}) const;
  Outcome judged(const std::vector<Walk>& walks, const Fault& fault) const;

 private:
  Pose tool_for(const Vec3& sphere_centre, const Quat& orientation) const;
  void add_gaps(Walk& walk) const;

  scene::Scene scene_;
  Vec3 tool_to_sphere_;
  std::unique_ptr<rendering::BuiltScene> built_;
  reference::ReferenceScene reference_;
};

/// The shell with all normals inverted.
pointshell::Pointshell flipped(const pointshell::Pointshell& shell);

}  // namespace voxtouch::test

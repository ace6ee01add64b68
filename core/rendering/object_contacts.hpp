#pragma once
/// Contact of the tool with every static object of a scene. Each has its own voxmap and material,
/// and some move.
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/contact/contact_renderer.hpp"
#include "core/effects/effect.hpp"
#include "core/scene/object_limit.hpp"
#include "core/types/motion.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::rendering {

/// Data of one object. It must not move, since the renderer refers to it.
struct StaticObject {
  std::uint32_t id = 0;  ///< 0: the static scene; n: Scene::objects[n - 1]
  std::string name;
  voxmap::Voxmap voxmap;
  std::optional<voxmap::DistanceField> field;
  /// The first of the resting objects that form one solid with it.
  std::optional<std::size_t> solid;
  std::optional<Motion> moves;  ///< displacement in W of the whole object over the scene's time
  std::optional<contact::ContactRenderer> renderer;
};

/// Sums the contacts of all objects. A moving object is queried at its rest position, with the tool
/// moved back by its displacement. For objects that form one solid, `original` and `adapted` use
/// the mean normal and the latched depths of all of them. One thread at a time.
class ObjectContacts {
 public:
  /// Takes 1 to kMaxObjects objects, in the order of their ids; otherwise throws
  /// std::invalid_argument.
  explicit ObjectContacts(std::vector<std::unique_ptr<StaticObject>> objects);

  /// Renders one frame of the ring; `tool` is T in W. `time_s` since the start of the session
  /// determines the positions of moving objects. Real-time safe.
  /// Wrench and stiffness are sums, hits are counted together, and depth and deepest point are
  /// those of the deepest object. The mean normal is that of all hits. A pose that is invalid for
  /// one object gives no contact at all.
  contact::StageResult render(const Pose& tool, double time_s) noexcept {
    return alone_ != nullptr ? alone_->render(tool) : render_all(tool, time_s);
  }
  /// The part of each object in the last `render`, whose result was `all`; refers to `all` if there
  /// is only one object. Real-time safe.
  std::span<const effects::ObjectContact> parts(const contact::StageResult& all) noexcept {
    if (alone_ != nullptr)
      parts_[0].contact = &all.contact;
    return parts_;
  }
  /// Scales the stiffness of each object's part of the last `render` by `part`, the displayed
  /// fraction. Real-time safe.
  void soften(double part) noexcept;
  /// Power [W] of moving objects on the tool in the last `render`; negative if the tool moved them.
  double power_w() const noexcept { return power_w_; }
  /// Clears the memory of each object's contact. Real-time safe.
  void reset() noexcept;

  /// Evaluates the memoryless models, with the ids of the points in surface voxels of any object,
  /// ascending and unique. Allocates.
  contact::ContactResult probe(const Pose& tool, std::vector<std::uint32_t>& surface_ids);

  std::size_t size() const noexcept { return objects_.size(); }
  StaticObject& object(std::size_t n) noexcept { return *objects_[n]; }
  const StaticObject& object(std::size_t n) const noexcept { return *objects_[n]; }
  bool moves() const noexcept { return moves_; }

 private:
  contact::StageResult render_all(const Pose& tool, double time_s) noexcept;
  MotionPoint find(StaticObject& object, const Pose& tool, double time_s) noexcept;

  std::vector<std::unique_ptr<StaticObject>> objects_;
  contact::ContactRenderer* alone_ =
      nullptr;  ///< the only object, if it rests: no cost in addition to its own contact
  std::vector<std::vector<contact::ContactRenderer*>> solids_;
  std::vector<MotionPoint> motions_;  ///< in the last `render`
  std::vector<contact::ContactResult> results_;
  std::vector<effects::ObjectContact> parts_;
  double power_w_ = 0.0;
  bool moves_ = false;
};

/// Adds the result of another object for the same frame, as described in ObjectContacts. Real-time
/// safe.
void add_contact(const contact::ContactResult& other, contact::ContactResult& sum) noexcept;

}  // namespace voxtouch::rendering

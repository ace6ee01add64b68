#pragma once
/// The tool against every static object of a scene: each has its own voxmap and material, and some
/// move.
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

/// The tool as the edges of static objects are looked up in it, in T.
struct ToolBody {
  voxmap::Voxmap voxmap;
  voxmap::DistanceField field;
};

/// An object's edge points (core/pointshell/edge_points.hpp) in the tool's voxmap. Both must
/// outlive it.
struct EdgeContacts {
  contact::ContactQuery query;
  const voxmap::DistanceField* tool_field;
};

/// What is built for one object. Stays where it is: the renderer points into it.
struct StaticObject {
  std::uint32_t id = 0;  ///< 0: the ground; n: Scene::objects[n - 1]
  std::string name;
  voxmap::Voxmap voxmap;
  std::optional<voxmap::DistanceField> field;
  pointshell::Pointshell edge_points;  ///< where there is a virtual tool, from the grid's origin;
                                       ///< empty once `edges` has them
  std::optional<std::size_t> solid;  ///< the first of the objects at rest that it is one solid with
  std::optional<Motion> moves;       ///< displacement in W of all of it over the scene's time
  std::optional<contact::ContactRenderer> renderer;
  std::unique_ptr<EdgeContacts> edges;  ///< null where there are none
};

/// Sums the contacts of all objects. An object that moves is looked up where it rests, with the
/// tool moved back by its displacement. `original` and `adapted` render objects that are one solid
/// with the mean normal and the memory of all of them. One thread at a time.
class ObjectContacts {
 public:
  /// 1 to kMaxObjects, in the order of their ids; std::invalid_argument otherwise.
  explicit ObjectContacts(std::vector<std::unique_ptr<StaticObject>> objects);

  /// One frame of the ring, `tool` = T in W. `time_s` since the session's begin: where moving
  /// objects are. Wrench and stiffness are sums, hits are counted together, depth and deepest point
  /// are those of the deepest object; the mean normal is that of all hits. A pose that one object
  /// cannot look up gives no contact at all. Real-time safe.
  contact::StageResult render(const Pose& tool, double time_s) noexcept {
    return alone_ != nullptr ? alone_->render(tool) : render_all(tool, time_s);
  }
  /// Each object's part of the last `render`, which gave `all`; points into it where there is one
  /// object only. Real-time safe.
  std::span<const effects::ObjectContact> parts(const contact::StageResult& all) noexcept {
    if (alone_ != nullptr)
      parts_[0].contact = &all.contact;
    return parts_;
  }
  /// Of what each object's part of the last `render` reports as its stiffness the hand gets `part`.
  /// Real-time safe.
  void soften(double part) noexcept;
  /// Power [W] with which moving objects pushed the tool in the last `render`; below zero where it
  /// pushed them.
  double power_w() const noexcept { return power_w_; }
  /// Each object's contact forgets its memory. Real-time safe.
  void reset() noexcept;

  /// The models alone, without memory, with the ids of the points in surface voxels of any object,
  /// ascending, each once. Allocates.
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
      nullptr;  ///< of the one object that rests: it costs nothing in addition to its own contact
  std::vector<std::vector<contact::ContactRenderer*>> solids_;
  std::vector<MotionPoint> motions_;  ///< in the last `render`
  std::vector<contact::ContactResult> results_;
  std::vector<effects::ObjectContact> parts_;
  double power_w_ = 0.0;
  bool moves_ = false;
};

/// Adds what another object gives to the same frame, as ObjectContacts says. Real-time safe.
void add_contact(const contact::ContactResult& other, contact::ContactResult& sum) noexcept;

}  // namespace voxtouch::rendering

#pragma once
/// Repeats the coupling of a recorded run: the designs, their first samples, and each contact.
#include <optional>
#include <string>
#include <vector>

#include "core/device_fit/fit_coupling.hpp"
#include "nodes/coupling/contact_coupling.hpp"
#include "nodes/replay/recording.hpp"

namespace voxtouch::replay {

/// With the recorded scene the recorded designs run, each from its first sample on. They are also
/// fitted again, to compare. With another scene the designs fitted to that scene run.
class CouplingReplay {
 public:
  CouplingReplay(const scene::Scene& scene, bool recorded_scene)
      : scene_(scene),
        recorded_scene_(recorded_scene),
        coupling_(scene.device) {}

  /// `session` must outlive this object, or last until the next session begins. Throws
  /// std::invalid_argument if a design cannot run.
  void begin_session(const RecordedSession& session, const rendering::StiffnessBounds& bounds,
                     const device_fit::SceneRequirements& demand);
  /// Bounds of the plan for the next contacts.
  void contact_displays(const rendering::StiffnessBounds& bounds,
                        const device_fit::SceneRequirements& demand);
  /// Empty if no coupling may run. Throws as begin_session does.
  std::optional<msg::ForceCommand> answer(const msg::ContactState& contact);

  std::uint64_t compared() const noexcept { return compared_; }  ///< recorded designs
  std::uint64_t differ() const noexcept { return differ_; }      ///< of these, that no fit gives
  /// Differences, and what could not be compared, a sentence each.
  const std::vector<std::string>& notes() const noexcept { return notes_; }

 private:
  device_fit::FittedCoupling fit(const rendering::StiffnessBounds& bounds,
                                 const device_fit::SceneRequirements& demand) const;
  void adopt(const device_fit::FittedCoupling& fitted);
  void adopt(const coupling_node::Adoption& design);
  void compare(const coupling_node::AdoptedCoupling& recorded);

  const scene::Scene& scene_;
  bool recorded_scene_;
  bool as_recorded_ = false;  ///< in this session
  coupling_node::ContactCoupling coupling_;
  const RecordedSession* session_ = nullptr;
  coupling::design::DeviceModel device_;
  rendering::StiffnessBounds bounds_;
  std::vector<device_fit::FittedCoupling>
      fits_;                     ///< from the one of the newest design on: of several
                                 ///< in a row only the last may have been made
  std::size_t next_design_ = 0;  ///< of the session's
  std::uint64_t compared_ = 0, differ_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace voxtouch::replay

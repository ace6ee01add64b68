#pragma once
/// The one table of topics: name, type, profile, rate.
#include <string>
#include <string_view>

#include "qos/profiles.hpp"

namespace voxtouch::qos {

/// One row. `path` is relative to the rig's namespace, unless `global`.
struct Topic {
  std::string_view path;
  std::string_view type;   ///< "pkg/msg/Name"
  ProfileId profile;       ///< in real time; see `profile_in`
  double rate_hz;          ///< 0: on a change only
  bool global = false;     ///< outside the rig's namespace: /tf, /diagnostics
  bool recorded = true;    ///< the logger records it unasked
};

inline constexpr Topic kDeviceState{"device/state", "voxtouch_msgs/msg/DeviceState", ProfileId::kStream, 1000};
inline constexpr Topic kContactState{"rendering/contact", "voxtouch_msgs/msg/ContactState", ProfileId::kStream, 1000};
inline constexpr Topic kForceCommand{"coupling/command", "voxtouch_msgs/msg/ForceCommand", ProfileId::kStream, 1000};
inline constexpr Topic kDeviceDescription{"device/description", "voxtouch_msgs/msg/DeviceDescription", ProfileId::kLatched, 0};
inline constexpr Topic kScenePlan{"rendering/plan", "voxtouch_msgs/msg/ScenePlan", ProfileId::kLatched, 0};
inline constexpr Topic kEffectChange{"rendering/change", "voxtouch_msgs/msg/EffectChange", ProfileId::kEvent, 0};
inline constexpr Topic kEffectChanged{"rendering/changed", "voxtouch_msgs/msg/EffectChanged", ProfileId::kStatus, 0};
inline constexpr Topic kCouplingDesign{"coupling/design", "voxtouch_msgs/msg/CouplingDesign", ProfileId::kLatched, 0};
inline constexpr Topic kValidation{"validation", "voxtouch_msgs/msg/ValidationReport", ProfileId::kEvent, 0};
inline constexpr Topic kNodeStatus{"node_status", "voxtouch_msgs/msg/NodeStatus", ProfileId::kStatus, 10};
inline constexpr Topic kDiagnostics{"diagnostics", "diagnostic_msgs/msg/DiagnosticArray", ProfileId::kState, 1, true, false};
inline constexpr Topic kTf{"tf", "tf2_msgs/msg/TFMessage", ProfileId::kState, 100, true, false};
inline constexpr Topic kPose{"pose", "geometry_msgs/msg/PoseStamped", ProfileId::kSensor, 100, false, false};
inline constexpr Topic kWrench{"wrench", "geometry_msgs/msg/WrenchStamped", ProfileId::kSensor, 100, false, false};
inline constexpr Topic kMarkers{"markers", "visualization_msgs/msg/MarkerArray", ProfileId::kState, 10, false, false};

inline constexpr Topic kTopics[] = {kDeviceState, kContactState,   kForceCommand, kDeviceDescription, kScenePlan,
                                    kCouplingDesign, kValidation,  kNodeStatus,   kDiagnostics,       kTf,
                                    kPose,           kWrench,      kMarkers,    kEffectChange,   kEffectChanged};

enum class TimeMode : std::uint8_t { kRealTime, kLockstep };

/// The profile that writers and full readers of `topic` use: in lockstep, streams and events must lose nothing.
constexpr const Profile& profile_in(const Topic& topic, TimeMode mode) {
  const bool flows = topic.profile == ProfileId::kStream || topic.profile == ProfileId::kEvent;
  return profile(mode == TimeMode::kLockstep && flows ? ProfileId::kLockstep : topic.profile);
}

/// "rt/<rig>/device/state", "rt/tf".
inline std::string dds_name(const Topic& topic, std::string_view rig) {
  std::string name = "rt/";
  if (!topic.global) name.append(rig).append("/");
  return name.append(topic.path);
}

}  // namespace voxtouch::qos

#pragma once
/// Table of topics: name, type, profile, rate, writers, readers, purpose.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "qos/profiles.hpp"

namespace voxtouch::qos {

/// Nodes of the ring, as a set.
using Nodes = std::uint8_t;
inline constexpr Nodes kNone = 0, kDevice = 1, kRendering = 2, kCoupling = 4, kValidator = 8,
                       kLogger = 16, kEveryNode = 31;

/// Names of the nodes in a set, as in statuses and options.
inline std::vector<std::string> names_of(Nodes nodes) {
  constexpr std::string_view kNames[] = {"device", "rendering", "coupling", "validator", "logger"};
  std::vector<std::string> names;
  for (std::size_t n = 0; n < std::size(kNames); ++n)
    if ((nodes >> n) & 1U)
      names.emplace_back(kNames[n]);
  return names;
}

/// One row. `path` is relative to the rig's namespace, unless `global`.
struct Topic {
  std::string_view path;
  std::string_view type;  ///< "pkg/msg/Name"
  ProfileId profile;      ///< in real time; see `profile_in`
  double rate_hz;         ///< 0: on a change only
  Nodes writers =
      kNone;  ///< kNone: programs that are not nodes of the ring, such as `voxtouch change`
  Nodes readers = kNone;  ///< of the ring; the logger is one of those that it records by default
  std::string_view why = {};   ///< it is written, for the scene's plan
  bool global = false;         ///< outside the rig's namespace: /tf, /diagnostics
  bool lockstep_only = false;  ///< there is no writer in real time
  bool with_external =
      false;  ///< the rendering reads it only if the scene has the effect `external`, in real time
  bool of_launcher = false;    ///< `voxtouch up` writes it
  bool of_arms = false;        ///< written only if the device is an arm with known joints
  bool with_led_hand = false;  ///< the device reads it only if a page leads the hand
};

inline constexpr Topic kDeviceState{
    "device/state",
    "voxtouch_msgs/msg/DeviceState",
    ProfileId::kStream,
    1000,
    kDevice,
    kRendering | kLogger,
    "One per sample of the device. The rendering computes its contact."};
inline constexpr Topic kContactState{"rendering/contact",
                                     "voxtouch_msgs/msg/ContactState",
                                     ProfileId::kStream,
                                     1000,
                                     kRendering,
                                     kCoupling | kValidator | kLogger,
                                     "One per sample. The coupling computes a command from it."};
inline constexpr Topic kForceCommand{"coupling/command",
                                     "voxtouch_msgs/msg/ForceCommand",
                                     ProfileId::kStream,
                                     1000,
                                     kCoupling,
                                     kDevice | kLogger,
                                     "One per sample. The device applies it."};
inline constexpr Topic kDeviceDescription{
    "device/description",
    "voxtouch_msgs/msg/DeviceDescription",
    ProfileId::kLatched,
    0,
    kDevice,
    kRendering | kCoupling | kLogger,
    "Begins a session; the coupling is designed for it. Once per session."};
inline constexpr Topic kScenePlan{
    "rendering/plan",
    "voxtouch_msgs/msg/ScenePlan",
    ProfileId::kLatched,
    0,
    kRendering,
    kCoupling | kValidator | kLogger,
    "Contact stiffness that the coupling is designed for. Once per session."};
inline constexpr Topic kCouplingDesign{
    "coupling/design",
    "voxtouch_msgs/msg/CouplingDesign",
    ProfileId::kLatched,
    0,
    kCoupling,
    kLogger,
    "The coupling that runs. Once per session and after each change."};
inline constexpr Topic kValidation{
    "validation",
    "voxtouch_msgs/msg/ValidationReport",
    ProfileId::kEvent,
    0,
    kValidator,
    kLogger,
    "Cross-checks of contacts. Only while a validator runs and the topic has a reader."};
inline constexpr Topic kNodeStatus{
    "node_status",
    "voxtouch_msgs/msg/NodeStatus",
    ProfileId::kStatus,
    10,
    kEveryNode,
    kEveryNode,
    "Heartbeat and state of each node. Ten times a second and after each change."};
inline constexpr Topic kEffectChange{
    "rendering/change",
    "voxtouch_msgs/msg/EffectChange",
    ProfileId::kEvent,
    0,
    kNone,
    kRendering | kLogger,
    "Requests to change the scene: from voxtouch change or any ROS 2 tool."};
inline constexpr Topic kEffectChanged{"rendering/changed",
                                      "voxtouch_msgs/msg/EffectChanged",
                                      ProfileId::kStatus,
                                      0,
                                      kRendering,
                                      kLogger,
                                      "Result of each request."};
inline constexpr Topic kEffectMade{
    "rendering/made",
    "voxtouch_msgs/msg/EffectChange",
    ProfileId::kRecord,
    0,
    kRendering,
    kLogger,
    "Each change that took effect, with session and first sample. Replay uses it."};
inline constexpr Topic kRecover{"recover",
                                "voxtouch_msgs/msg/Recover",
                                ProfileId::kEvent,
                                0,
                                kNone,
                                kDevice | kCoupling | kLogger,
                                "Resets a fault latch: voxtouch recover."};
inline constexpr Topic kOperatorTarget{
    "operator/target",
    "voxtouch_msgs/msg/OperatorTarget",
    ProfileId::kTap,
    0,
    kNone,
    kDevice | kLogger,
    "Requested position of a simulated device's hand, from the page.",
    false,
    false,
    false,
    false,
    false,
    true};
inline constexpr Topic kRigClaim{
    "rig_claim",
    "voxtouch_msgs/msg/RigClaim",
    ProfileId::kStatus,
    0,
    kNone,
    kEveryNode,
    "Names the rig's `voxtouch up` and the participants that may take its roles.",
    false,
    false,
    false,
    true};
inline constexpr Topic kExternalWrench{
    "external",
    "geometry_msgs/msg/WrenchStamped",
    ProfileId::kTap,
    0,
    kNone,
    kRendering,
    "Wrench that the effect 'external' displays, from one program outside the ring.",
    false,
    false,
    true};
inline constexpr Topic kExternalSample{"rendering/external",
                                       "voxtouch_msgs/msg/ExternalSample",
                                       ProfileId::kEvent,
                                       0,
                                       kRendering,
                                       kLogger,
                                       "Value of the external wrench per sample, for replay.",
                                       false,
                                       false,
                                       true};
inline constexpr std::string_view kForRos =
    "For ROS tools. Written outside the loop, only while it has a reader.";
inline constexpr Topic kDiagnostics{"diagnostics",
                                    "diagnostic_msgs/msg/DiagnosticArray",
                                    ProfileId::kState,
                                    1,
                                    kEveryNode,
                                    kNone,
                                    "For ROS tools. Written only while it has a reader.",
                                    true};
inline constexpr Topic kParameterEvents{
    "parameter_events",
    "rcl_interfaces/msg/ParameterEvent",
    ProfileId::kState,
    0,
    kRendering,
    kNone,
    "Parameter changes, for ROS tools. Written only while it has a reader.",
    true};
inline constexpr Topic kRosout{"rosout",
                               "rcl_interfaces/msg/Log",
                               ProfileId::kLog,
                               0,
                               kEveryNode,
                               kNone,
                               "Log messages, for ROS tools. Written only while it has a reader.",
                               true};
inline constexpr Topic kJointStates{
    "joint_states",
    "sensor_msgs/msg/JointState",
    ProfileId::kState,
    100,
    kDevice,
    kNone,
    "Joints of an arm, for ROS tools. Written outside the loop, only while it has a reader.",
    true,
    false,
    false,
    false,
    true};
inline constexpr Topic kRobotDescription{
    "robot_description",
    "std_msgs/msg/String",
    ProfileId::kLatched,
    0,
    kDevice,
    kNone,
    "Model of the arm, for ROS tools. Written once, only while it has a reader.",
    true,
    false,
    false,
    false,
    true};
inline constexpr Topic kTf{
    "tf", "tf2_msgs/msg/TFMessage", ProfileId::kState, 100, kRendering, kNone, kForRos, true};
inline constexpr Topic kTfStatic{
    "tf_static",
    "tf2_msgs/msg/TFMessage",
    ProfileId::kLatched,
    0,
    kRendering,
    kNone,
    "Fixed frames, for ROS tools. Written once, only while it has a reader.",
    true};
inline constexpr Topic kClock{
    "clock",
    "rosgraph_msgs/msg/Clock",
    ProfileId::kState,
    100,
    kRendering,
    kNone,
    "Simulated time in lockstep, for ROS tools. Written only while it has a reader.",
    true,
    true};
inline constexpr Topic kPose{
    "pose", "geometry_msgs/msg/PoseStamped", ProfileId::kState, 100, kRendering, kNone, kForRos};
inline constexpr Topic kWrench{
    "wrench", "geometry_msgs/msg/WrenchStamped", ProfileId::kState, 100, kRendering, kNone,
    kForRos};
inline constexpr Topic kMarkers{
    "markers", "visualization_msgs/msg/MarkerArray", ProfileId::kState, 10, kRendering, kNone,
    kForRos};

inline constexpr Topic kTopics[] = {kDeviceState,
                                    kContactState,
                                    kForceCommand,
                                    kDeviceDescription,
                                    kScenePlan,
                                    kCouplingDesign,
                                    kValidation,
                                    kNodeStatus,
                                    kEffectChange,
                                    kEffectChanged,
                                    kEffectMade,
                                    kRecover,
                                    kOperatorTarget,
                                    kRigClaim,
                                    kDiagnostics,
                                    kParameterEvents,
                                    kRosout,
                                    kJointStates,
                                    kRobotDescription,
                                    kTf,
                                    kTfStatic,
                                    kClock,
                                    kPose,
                                    kWrench,
                                    kMarkers,
                                    kExternalWrench,
                                    kExternalSample};

enum class TimeMode : std::uint8_t { kRealTime, kLockstep };

/// The profile that writers and full readers of `topic` use: in lockstep, streams and events must
/// lose nothing.
constexpr const Profile& profile_in(const Topic& topic, TimeMode mode) {
  const bool flows = topic.profile == ProfileId::kStream || topic.profile == ProfileId::kEvent;
  return profile(mode == TimeMode::kLockstep && flows ? ProfileId::kLockstep : topic.profile);
}

/// "rt/<rig>/device/state", "rt/tf".
inline std::string dds_name(const Topic& topic, std::string_view rig) {
  std::string name = "rt/";
  if (!topic.global)
    name.append(rig).append("/");
  return name.append(topic.path);
}

/// The row of the external wrench for the absolute topic that a scene names ("/sim/wrench"), or for
/// that of the rig if empty. Refers to `ros_name`, which must outlive it.
inline Topic external_topic(std::string_view ros_name) {
  Topic row = kExternalWrench;
  if (!ros_name.empty())
    row.path = ros_name.substr(1), row.global = true;
  return row;
}

/// How figures in statuses call a topic: "device_state".
inline std::string figure_name(const Topic& topic) {
  std::string name(topic.path);
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

}  // namespace voxtouch::qos

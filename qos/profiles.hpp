#pragma once
/// Named QoS profiles. Every DDS endpoint uses one of these, so that one test can check all pairs
/// of writers and readers.
#include <cstdint>
#include <memory>
#include <string_view>

#include <dds/dds.h>

namespace voxtouch::qos {

enum class ProfileId : std::uint8_t {
  kStream,
  kLockstep,
  kLatched,
  kEvent,
  kStatus,
  kTap,
  kState,
  kService,
  kLog,
  kRecord
};

/// Policies of a profile. All are shared ownership, by reception, automatic liveliness, no lifespan
/// and no latency budget (a latency budget above 0 makes Cyclone DDS batch samples asynchronously).
struct Profile {
  ProfileId id;
  std::string_view name;
  bool reliable;
  bool transient_local;  ///< a reader must request it too, otherwise it receives no earlier samples
  bool keep_all;         ///< bounded by `depth` as resource limit; else keep last `depth`
  std::int32_t depth;
  double deadline_periods;  ///< 0: none. One period fires falsely; three do not
};

inline constexpr Profile kProfiles[] = {
    // id, name, reliable, transient local, keep all, depth, deadline
    {ProfileId::kStream, "stream", false, false, false, 1,
     3.0},  // the ring in real time: newest sample wins
    {ProfileId::kLockstep, "lockstep", true, false, true, 256,
     0.0},  // the ring in simulated time: nothing is lost
    {ProfileId::kLatched, "latched", true, true, false, 1,
     0.0},  // one value that late joiners get too
    {ProfileId::kEvent, "event", true, false, false, 256, 0.0},  // reports
    {ProfileId::kStatus, "status", true, true, false, 64,
     0.0},  // as latched; readers keep many writers' last
    {ProfileId::kTap, "tap", false, false, false, 64,
     0.0},  // matches every stream and event, slows none
    {ProfileId::kState, "state", true, false, false, 10,
     0.0},  // ROS standard types; a full history drops, no writer waits
    {ProfileId::kService, "service", true, false, false, 64,
     0.0},  // requests and replies; a stalled client blocks no writer
    {ProfileId::kLog, "log", true, true, false, 64,
     0.0},  // /rosout: late joiners receive the last lines too
    {ProfileId::kRecord, "record", true, true, false, 256,
     0.0},  // complete history, also for a recorder that joins late or was suspended
};

constexpr const Profile& profile(ProfileId id) {
  for (const Profile& p : kProfiles)
    if (p.id == id)
      return p;
  return kProfiles[0];
}

struct QosDelete {
  void operator()(dds_qos_t* qos) const noexcept { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDelete>;

enum class Endpoint : std::uint8_t { kWriter, kReader };

/// The DDS QoS of one endpoint; `period_s` is the topic's period (0: none).
Qos make_qos(const Profile& profile, Endpoint endpoint, double period_s);

}  // namespace voxtouch::qos

#pragma once
/// Input of a replay from a bag: the samples by number, and the other messages.
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/types/device_description.hpp"
#include "nodes/coupling/design_message.hpp"
#include "nodes/runtime/figure.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::replay {

/// One sample and its answers, each as far as the bag has it.
struct RecordedSample {
  std::optional<msg::DeviceState> state;
  std::optional<msg::ContactState> contact;
  std::optional<msg::ForceCommand> command;
  std::vector<msg::ForceCommand> again;  ///< the same sample's, once more: DDS gave the coupling
                                         ///< its contact twice, or the command to the recorder
  std::optional<msg::ExternalSample> external;  ///< the wrench of the effect `external` in it
  /// Whether the rendering answered it: in real time it and the coupling leave samples out. A
  /// contact that the recorder lost shows by its command.
  bool rendered() const noexcept { return contact || command || external; }
};

/// A change that the rendering has made.
struct RecordedChange {
  std::uint64_t session = 0;      ///< 0: before any
  std::uint64_t from_sample = 0;  ///< the first that it holds for
  std::string sentence{};         ///< the rendering's
  bool requested = false;         ///< the bag holds the request: the fields below
  std::uint32_t action = 0;
  std::string effect{}, parameter{}, model{};
  std::array<double, 3> value{};
  double voxel_size_m = 0.0;
};

/// The plan of the scene from a sample on.
struct RecordedPlan {
  std::uint64_t session = 0, from_sample = 0;
  std::string scene_hash{};
};

struct RecordedSession {
  std::uint64_t id = 0;
  std::map<std::uint64_t, RecordedSample> samples{};  ///< by sequence number
  std::optional<DeviceDescription> device{};          ///< the first that it was described as
  bool described_anew = false;
  std::vector<coupling_node::Adoption> designs{};  ///< in the order that they were taken up
};

struct Recording {
  std::string rig;
  std::filesystem::path scene_file;  ///< as the rendering reported it, or empty
  std::string scene, scene_hash;     ///< as the rendering named them first
  bool lockstep = false;
  std::vector<RecordedSession> sessions;  ///< in the order that their first samples were recorded
  std::vector<RecordedChange> changes;    ///< in the order that they were made
  std::vector<RecordedPlan> plans;
  std::size_t designs = 0;                                   ///< of all sessions
  std::map<std::string, runtime::Figures> figures;           ///< each node's last
  std::map<std::string, std::set<std::uint32_t>> processes;  ///< of each node, by its statuses
  std::vector<std::string>
      losses;  ///< data that the bag's metadata states and its files do not hold
  std::vector<std::string> warnings;  ///< irregularities that did not prevent reading
};

/// Reads `path`, a bag's folder or one of its files, of the given rig, or of the only one if `rig`
/// is empty. Throws std::runtime_error if nothing can be replayed: no bag, a damaged one, one of
/// another program or version, without device samples or description. Keeps the whole run in
/// memory, about 1 MB for each second.
Recording read_recording(const std::filesystem::path& path, const std::string& rig);

}  // namespace voxtouch::replay

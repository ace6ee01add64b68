#pragma once
/// Repeats rendering and coupling of a recorded run and compares the results with the recorded
/// ones.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/replay/message_difference.hpp"
#include "nodes/replay/replayed_bag.hpp"

namespace voxtouch::replay {

struct ReplayOptions {
  std::filesystem::path bag,
      scene;            ///< `scene` instead of the recorded one; empty: the file that the bag names
  std::string rig;      ///< empty: that of the bag
  bool curves = false;  ///< keep them
  bool answers = false;  ///< keep them
};

/// Forces of one run.
struct ForceStatistics {
  double most_n = 0.0;
  double squares = 0.0;  ///< sum over the samples
  std::uint64_t samples = 0, touching = 0;
  double rms_n() const noexcept;
  double fraction() const noexcept {
    return samples > 0 ? static_cast<double>(touching) / static_cast<double>(samples) : 0.0;
  }
};
struct ForcesCompared {
  ForceStatistics recorded, replayed;
};

/// Sizes of force over the time since the first sample.
struct ForceCurves {
  std::vector<double> t_s, recorded_n, replayed_n;
};

struct SceneName {
  std::string name, hash, file;
};

struct Replayed {
  std::string bag, rig, device;
  bool lockstep = false;
  SceneName recorded, replayed;
  bool same_scene() const noexcept { return recorded.hash == replayed.hash; }
  double duration_s = 0.0;    ///< of the device's time
  std::uint64_t samples = 0;  ///< of the device, in the bag
  std::uint64_t skipped = 0;  ///< that the rendering did not answer, so they are not rendered here
  std::uint64_t lost_states = 0,
                lost_contacts = 0;  ///< that the recorder lost, as their answers state
  std::uint64_t sessions = 0, changes = 0;
  Comparison<msg::ContactState> contact;
  Comparison<msg::ForceCommand> command;
  std::uint64_t designs = 0,
                designs_differ = 0;   ///< recorded designs that were compared with this build's
  ForcesCompared rendered, returned;  ///< by the rendering; by the coupling, to the hand
  Answers answers;
  std::string
      other_build;  ///< another build, with answers that replace the recorded ones; empty: none
  ForceCurves rendered_curves, returned_curves;
  std::vector<std::string> notes;  ///< findings and irregularities
  std::vector<std::string>
      missing;  ///< missing data of the bag, with the first sample from which bits may differ
  std::vector<std::string>
      losses;  ///< data that the bag's metadata states and its files do not hold
  bool equal() const noexcept {
    return contact.differ == 0 && command.differ == 0 && designs_differ == 0 && losses.empty();
  }
  /// Whether half of the samples that the rendering answered were compared, in both streams.
  bool is_complete() const noexcept {
    return 2 * std::min(contact.compared, command.compared) >= samples - std::min(skipped, samples);
  }
  bool passed() const noexcept {
    return equal() && is_complete() && contact.compared + command.compared > 0;
  }
};

/// Throws std::runtime_error if the bag cannot be replayed, and as scene files and meshes do if the
/// scene cannot be built.
Replayed replay(const ReplayOptions& options);

}  // namespace voxtouch::replay

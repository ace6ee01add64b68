#pragma once
/// What `up` prints of a scene and a machine before any force: little, so that what matters is
/// read.
#include <string>
#include <vector>

#include "nodes/cli/up/run_record.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::cli {

/// How many warnings a start says in full.
inline constexpr std::size_t kWarningsAtStart = 2;

/// The lines to be said: the first warnings, and one that counts the others and names the verbs
/// that list them.
std::vector<std::string> limited_warnings(const std::vector<std::string>& warnings,
                                          const std::string& scene);

/// What the nodes will be refused, in one warning that names `voxtouch doctor`; empty where nothing
/// is. They keep each sentence in their statuses and say nothing themselves.
std::vector<std::string> warnings_of_machine(const runtime::RealtimeOptions& options);

/// Prints each part once, as soon as the nodes have reported it. Pure.
class StartReport {
 public:
  /// `warnings`: of the scene file, then of the machine. `scene`: as it was typed.
  StartReport(std::vector<std::string> warnings, std::string scene, std::string device);
  /// The lines that are due: with the rendering's first report of its built scene the warnings, its
  /// own among them; with the coupling's first report of a coupling that may run the force preview.
  std::vector<std::string> poll(const Reports& reports);
  /// Whether the rendering has built its scene.
  static bool scene_is_built(const Reports& reports);

 private:
  std::vector<std::string> warnings_;
  std::string scene_, device_;
  bool warned_ = false, previewed_ = false;
};

}  // namespace voxtouch::cli

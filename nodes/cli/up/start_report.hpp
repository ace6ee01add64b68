#pragma once
/// Output of `up` about scene and machine before any force, kept short.
#include <string>
#include <vector>

#include "nodes/cli/up/run_record.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::cli {

/// Number of warnings that are printed in full at the start.
inline constexpr std::size_t kWarningsAtStart = 2;

/// The first warnings, and one line that counts the others and names the verbs that list them.
std::vector<std::string> limited_warnings(const std::vector<std::string>& warnings,
                                          const std::string& scene);

/// Missing rights of the nodes, in one warning that names `voxtouch doctor`; empty if there are
/// none. The nodes report each sentence in their statuses and print nothing.
std::vector<std::string> warnings_of_machine(const runtime::RealtimeOptions& options);

/// Prints each part once, as soon as the nodes have reported it. Pure.
class StartReport {
 public:
  /// `warnings`: of the scene file, then of the machine. `scene`: as on the command line.
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

#pragma once
/// The next run, chosen on a page: this process becomes it.
#include <filesystem>
#include <optional>
#include <string>

#include "nodes/cli/up/ring_run.hpp"

namespace voxtouch::cli {

/// Address of the page that continues, for `voxtouch view`.
inline constexpr const char* kPageVariable = "VOXTOUCH_PAGE";

/// A private folder for the choice, removed at the end. Without one, pages choose nothing.
class ChoiceFolder {
 public:
  /// If the run leaves no recording behind: the next one has none either.
  explicit ChoiceFolder(const UpOptions& options);
  ~ChoiceFolder();
  ChoiceFolder(const ChoiceFolder&) = delete;
  ChoiceFolder& operator=(const ChoiceFolder&) = delete;

  /// Empty: none.
  std::filesystem::path file() const { return folder_.empty() ? folder_ : folder_ / "choice"; }

 private:
  std::filesystem::path folder_;
};

struct NextRun {
  std::string scene, device, page;  ///< `page`: its address
};
/// The choice of a page; empty if there is none.
std::optional<NextRun> read_choice(const std::filesystem::path& file);
/// The previous run, which replaces a run that cannot start; empty if there is none.
std::optional<NextRun> take_previous();

/// Becomes the next run in the same rig. Throws std::runtime_error if it cannot be started.
void become(const UpOptions& options, const NextRun& next, bool can_go_back);

}  // namespace voxtouch::cli

#pragma once
/// Saves the last ten seconds of a ring as a recording with a report, when a page requests it.
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "nodes/bus/participant.hpp"
#include "nodes/bus/raw_reader.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/view/recent_messages.hpp"

namespace voxtouch::view {

/// What only the command line can do.
struct SaveActions {
  /// A new, empty folder for a recording of this scene; its name alone if it cannot be made.
  std::function<std::filesystem::path(const std::string& scene)> make_folder;
  /// Writes a report into that folder. Takes seconds; throws std::exception, a sentence.
  std::function<void(const std::filesystem::path& folder)> report;
};

/// Taps of all topics that a logger records. A message that a tap loses is missing. One thread
/// calls it, and none of its calls waits; its end waits for a report that is being written.
class LastSeconds {
 public:
  /// Throws bus::Error.
  LastSeconds(const bus::Participant& participant, const runtime::NodeOptions& options,
              const SaveActions& actions);

  /// To be called often.
  void take();
  /// One recording is saved at a time; further requests are refused.
  void save(const std::string& scene);
  bool is_saving() const noexcept { return saving_.valid(); }
  struct Answer {
    bool ok = false;
    std::string sentence;
  };
  /// What became of a request since the last call.
  std::optional<Answer> poll();

 private:
  struct Source {
    bus::RawReader reader;
    bus::GraphEntry graph_entry;  ///< entry for ROS 2 tools
  };
  const SaveActions& actions_;
  std::vector<bag::TopicInfo> topics_;
  std::vector<Source> sources_;  ///< as topics_
  RecentMessages recent_;
  std::optional<Answer> refusal_;
  std::future<Answer> saving_;
};

}  // namespace voxtouch::view

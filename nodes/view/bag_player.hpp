#pragma once
/// Plays a recorded run: play, pause, speed, seek.
#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "nodes/bag/bag_reader.hpp"
#include "nodes/bus/participant.hpp"
#include "nodes/view/facts.hpp"
#include "nodes/view/node_table.hpp"
#include "nodes/view/picture.hpp"

namespace voxtouch::view {

class BagPlayer {
 public:
  /// Throws std::runtime_error, with a sentence, if `path` is not a bag or has no messages of a
  /// ring.
  BagPlayer(const bus::Participant& participant, const std::filesystem::path& path);
  ~BagPlayer();

  /// At the end of the recording, `play(true)` restarts it.
  void play(bool on);
  void speed(double times);  ///< kSlowest to kFastest
  /// Jumps to a time since the first message; delivers the kPastS before it as well.
  void seek(double to_s);
  /// Advances the playback by `elapsed_s` and delivers the messages in between. Returns true after
  /// a jump, which clears picture, facts and nodes.
  bool advance(double elapsed_s, Picture& picture, Facts& facts, NodeTable& nodes);

  /// {t, duration, playing, speed, verdict: null or {good, problems}}. A damaged bag is not `good`.
  nlohmann::json to_json() const;
  /// Message about unreadable parts and steps of the recorder's clock; empty if there are none.
  std::string note() const;
  /// From the status of the rendering node; empty if unknown.
  const std::string& scene_file() const noexcept { return scene_file_; }
  /// The playback's time, in the bag's clock [ns].
  std::int64_t now_ns() const noexcept;

  static constexpr double kSlowest = 0.01, kFastest = 16.0;

  /// Delivers one message of a topic.
  using Handler = std::function<void(const bag::BagMessage&, Picture&, Facts&, NodeTable&)>;

 private:
  struct Topic {
    Handler handle;        ///< empty: the topic is not displayed
    bool is_rare = false;  ///< its last message stays valid
  };
  struct RareMessage {
    std::int64_t time_ns = 0;
    std::size_t topic = 0;
    std::vector<std::byte> bytes;
  };
  /// An interval without messages that is too long for a ring: the recorder's clock stepped. The
  /// playback skips it.
  struct ClockStep {
    std::int64_t from_ns = 0, length_ns = 0;
  };
  void find_steps();
  double duration_s() const noexcept;
  void report_damage(const std::string& sentence);
  std::string damage() const;
  void deliver(std::int64_t from_ns, std::int64_t to_ns, Picture& picture, Facts& facts,
               NodeTable& nodes);
  void collect_facts(const std::filesystem::path& path);

  bag::BagReader reader_;
  nlohmann::json verdict_;                  ///< of `up`
  std::vector<Topic> topics_;               ///< of the bag, by index
  std::vector<RareMessage> rare_messages_;  ///< by time; owned by `collecting_` until `collected_`
  std::int64_t begin_ns_ = 0, end_ns_ = 0;
  std::vector<ClockStep> steps_;  ///< by time
  mutable std::mutex mutex_;
  std::string damage_;  ///< guarded by `mutex_`
  double at_s_ = 0.0, speed_ = 1.0;
  bool playing_ = true;
  std::optional<double> seek_s_ = 0.0;
  std::string scene_file_;
  std::atomic<bool> stop_{false}, collected_{false};
  bool had_all_facts_ = false;
  std::thread collecting_;
};

}  // namespace voxtouch::view

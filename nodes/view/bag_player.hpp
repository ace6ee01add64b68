#pragma once
/// A recorded run as if it ran now: play, pause, speed, any place.
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
  /// Throws std::runtime_error, a sentence, where `path` is no bag or holds nothing of a ring.
  BagPlayer(const bus::Participant& participant, const std::filesystem::path& path);
  ~BagPlayer();

  /// Also from the end, which begins once more.
  void play(bool on);
  void speed(double times);  ///< kSlowest to kFastest
  /// Goes to a time since the first message and shows what was then, with the kPastS before it.
  void seek(double to_s);
  /// Takes what was recorded up to where the clock now is. True where a jump was made: what was
  /// shown before is gone.
  bool advance(double elapsed_s, Picture& picture, Facts& facts, NodeTable& nodes);

  /// {t, duration, playing, speed, verdict: null or {good, problems}}. A damaged bag is not good.
  nlohmann::json to_json() const;
  /// For people: what could not be read, and where the recorder's clock stepped. Empty: nothing.
  std::string note() const;
  /// As the rendering node said it; empty where it did not.
  const std::string& scene_file() const noexcept { return scene_file_; }
  /// Of the bag's times, as NodeTable receives them [ns].
  std::int64_t now_ns() const noexcept;

  static constexpr double kSlowest = 0.01, kFastest = 16.0;

  /// What becomes of a message of one topic.
  using Take = std::function<void(const bag::BagMessage&, Picture&, Facts&, NodeTable&)>;

 private:
  struct Topic {
    Take take;            ///< none: nothing of it is shown
    bool seldom = false;  ///< its last message counts, however old it is
  };
  struct Seldom {
    std::int64_t time_ns = 0;
    std::size_t topic = 0;
    std::vector<std::byte> bytes;
  };
  /// A time without messages that is too long for a ring: the recorder's clock stepped. It is
  /// skipped.
  struct Step {
    std::int64_t from_ns = 0, length_ns = 0;
  };
  void find_steps();
  double duration_s() const noexcept;
  void damaged(const std::string& sentence);
  std::string damage() const;
  void feed(std::int64_t from_ns, std::int64_t to_ns, Picture& picture, Facts& facts,
            NodeTable& nodes);
  void collect_facts(const std::filesystem::path& path);

  bag::BagReader reader_;
  nlohmann::json verdict_;     ///< of `up`, on the run
  std::vector<Topic> topics_;  ///< of the bag, by index
  std::vector<Seldom>
      seldom_;  ///< all such messages, by time; of the thread that collects them, until it has
  std::int64_t begin_ns_ = 0, end_ns_ = 0;
  std::vector<Step> steps_;  ///< by time
  mutable std::mutex mutex_;
  std::string damage_;  ///< of both threads, under the mutex
  double at_s_ = 0.0, speed_ = 1.0;
  bool playing_ = true;
  std::optional<double> seek_s_ = 0.0;
  std::string scene_file_;
  std::atomic<bool> stop_{false}, collected_{false};
  bool knew_all_ = false;
  std::thread collecting_;
};

}  // namespace voxtouch::view

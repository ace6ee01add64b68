#pragma once
/// Lockstep: who must have matched whom before sample 0, and who is still there.
#include <atomic>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "qos/topics.hpp"

namespace voxtouch::runtime {

/// One endpoint of this node and the nodes that must be at its other end.
struct Link {
  std::string what;  ///< the topic, for people
  std::function<std::vector<bus::Guid>()> matched;
  std::vector<std::string> nodes;
};

/// The links of a node's own writer and reader: by the table of topics, who reads what it writes,
/// and who writes what it reads. The endpoint must outlive the link.
template <class Writer>
Link link_of_writer(const qos::Topic& topic, const Writer& writer) {
  return {std::string(topic.path), [&writer] { return writer.matched(); },
          qos::names_of(topic.readers)};
}
template <class Reader>
Link link_of_reader(const qos::Topic& topic, const Reader& reader) {
  return {std::string(topic.path), [&reader] { return reader.matched(); },
          qos::names_of(topic.writers)};
}

/// Keeps only the nodes that take part in this run ("device" always does).
std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes);

/// What is still missing, for people: "validator on rendering/contact". Empty when every link has
/// matched all its nodes; in real time nobody is waited for, so it is always empty there.
std::string missing_links(const NodeOptions& options, const NodeRegistry& registry,
                          const std::vector<Link>& links);

/// Lockstep: the participants that a run waits for, and that alone can end it by their silence:
/// those that were ready for its session, each at the other end of every link that names its node,
/// when the last node was. Who comes later may call itself what it likes.
class Partners {
 public:
  explicit Partners(std::vector<std::string> nodes) : nodes_(std::move(nodes)) {}
  /// `session`: a new one begins with nobody. In real time nobody is waited for.
  void update(const NodeOptions& options, const NodeRegistry& registry,
              const std::vector<Link>& links, std::uint64_t session);
  /// Whether every node that takes part has been ready; from then on nobody joins.
  bool complete() const noexcept { return complete_; }
  /// The nodes that are not ready yet.
  const std::vector<std::string>& missing() const noexcept { return missing_; }
  const std::set<bus::Guid>& participants() const noexcept { return participants_; }

 private:
  std::vector<std::string> nodes_, missing_;
  std::set<bus::Guid> participants_;
  std::uint64_t session_ = 0;
  bool complete_ = false;
};

/// When latched values are written once more: once a second while a node that needs them is there
/// and has not answered for the session. A flood of foreign values may have kept them from it, or
/// it was refused before it was known whose is needed.
class Reminder {
 public:
  /// For `topic`: its readers but the logger, which needs no session's answer.
  bool is_due(const NodeRegistry& registry, std::uint64_t session, const qos::Topic& topic);

 private:
  std::int64_t answered_ns_ = 0;  ///< monotonic: last time that all had, or that one was reminded
};

/// A device session as one node sees it. The loop writes, the housekeeping reads.
class Session {
 public:
  /// From the loop, once everything is reset and what is latched has been published.
  void begin(std::uint64_t id) noexcept {
    count_.fetch_add(1, std::memory_order_relaxed);
    id_.store(id, std::memory_order_release);
  }
  void stop() noexcept { stopped_.store(true, std::memory_order_release); }

  /// What all nodes but the device report alike: session, state, count of sessions. Ready once a
  /// session has begun and every link has matched; running once `busy`. Returns what it waits for
  /// (`first` before any session), empty when ready. One thread.
  std::string report_to(NodeReport& report, const NodeOptions& options,
                        const NodeRegistry& registry, const std::vector<Link>& links,
                        std::string_view first, bool busy);
  bool stopped() const noexcept { return stopped_.load(std::memory_order_acquire); }

 private:
  std::atomic<std::uint64_t> id_{0}, count_{0};
  std::atomic<bool> stopped_{false};
  Partners partners_{{"device", "rendering", "coupling", "logger", "validator"}};
};

}  // namespace voxtouch::runtime

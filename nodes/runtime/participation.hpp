#pragma once
/// Which nodes must have matched before a run begins, and in lockstep which are still there.
/// --peers and the device take part.
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

/// To all nodes that the table of topics has at the other end. The endpoint must outlive the link.
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

/// Those that take part in this run; "device" always does.
std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes);

/// Links that have not matched all nodes that take part, for people: "validator on
/// rendering/contact". Empty if all have. `with_device`: the device too.
std::string missing_links(const NodeOptions& options, const NodeRegistry& registry,
                          const std::vector<Link>& links, bool with_device = true);

/// Lockstep: the participants that a run waits for, and that alone end it by their silence: those
/// that were ready for its session and at the other end of every link of their node when the last
/// node was. Participants that come later are none of them.
class PeerSet {
 public:
  explicit PeerSet(std::vector<std::string> nodes) : nodes_(std::move(nodes)) {}
  /// A new session begins with none; in real time there are none.
  void update(const NodeOptions& options, const NodeRegistry& registry,
              const std::vector<Link>& links, std::uint64_t session);
  /// Every node that takes part has been ready; none joins any more.
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

/// When latched values are written again: once a second while a node that needs them has not
/// answered for the session. A flood of foreign values may have hidden them, or they came before
/// their writer was bound.
class RepublishTimer {
 public:
  /// By the readers of `topic` but the logger, which answers for no session.
  bool is_due(const NodeRegistry& registry, std::uint64_t session, const qos::Topic& topic);

 private:
  std::int64_t answered_ns_ = 0;  ///< when all had answered, or it was due
};

/// A device session as one node sees it. The loop writes, the monitor reads.
class Session {
 public:
  /// From the loop, once everything is reset and what is latched has been published.
  void begin(std::uint64_t id) noexcept {
    count_.fetch_add(1, std::memory_order_relaxed);
    id_.store(id, std::memory_order_release);
  }
  void stop() noexcept { stopped_.store(true, std::memory_order_release); }

  /// Session, state and count of sessions, of all nodes but the device. Ready for a device, without
  /// a session, once every link but those to the device has matched. Ready for a session once it
  /// has begun and, in lockstep, every link has matched; running once `busy`. Returns what it waits
  /// for (`first` before any session); empty: nothing. One thread.
  std::string report_to(NodeReport& report, const NodeOptions& options,
                        const NodeRegistry& registry, const std::vector<Link>& links,
                        std::string_view first, bool busy);
  std::uint64_t id() const noexcept { return id_.load(std::memory_order_acquire); }
  bool stopped() const noexcept { return stopped_.load(std::memory_order_acquire); }

 private:
  std::atomic<std::uint64_t> id_{0}, count_{0};
  std::atomic<bool> stopped_{false};
  PeerSet partners_{{"device", "rendering", "coupling", "logger", "validator"}};
};

}  // namespace voxtouch::runtime

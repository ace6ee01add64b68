#pragma once
/// Which nodes must have matched when a run begins, and in lockstep which are still present. The
/// device and the nodes of --peers participate.
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

/// One endpoint of this node and the nodes required at its other end.
struct Link {
  std::string what;  ///< the topic, for messages
  std::function<std::vector<bus::Guid>()> matched;
  std::vector<std::string> nodes;
};

/// Links to all nodes that the topic table lists at the other end. The endpoint must outlive the
/// link.
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

/// The nodes that participate in this run. "device" always does.
std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes);

/// Links that have not matched all participating nodes, for messages: "validator on
/// rendering/contact". Empty if all have matched. `with_device`: include the device.
std::string missing_links(const NodeOptions& options, const NodeRegistry& registry,
                          const std::vector<Link>& links, bool with_device = true);

/// Lockstep: the participants that a run waits for, and whose silence ends it. They are those that
/// were ready for the session, and at the other end of every link, when the last node became ready.
/// Later participants do not belong to the set.
class PeerSet {
 public:
  explicit PeerSet(std::vector<std::string> nodes) : nodes_(std::move(nodes)) {}
  /// A new session begins with an empty set. In real time the set stays empty.
  void update(const NodeOptions& options, const NodeRegistry& registry,
              const std::vector<Link>& links, std::uint64_t session);
  /// Whether every participating node has been ready. The set is then final.
  bool complete() const noexcept { return complete_; }
  /// The nodes that are not ready.
  const std::vector<std::string>& missing() const noexcept { return missing_; }
  const std::set<bus::Guid>& participants() const noexcept { return participants_; }

 private:
  std::vector<std::string> nodes_, missing_;
  std::set<bus::Guid> participants_;
  std::uint64_t session_ = 0;
  bool complete_ = false;
};

/// Decides when latched values are written again: once a second while a node that needs them has
/// not confirmed the session. Foreign values may have displaced them, or they arrived while their
/// writer was unbound.
class RepublishTimer {
 public:
  /// For the readers of `topic` except the logger, which confirms no session.
  bool is_due(const NodeRegistry& registry, std::uint64_t session, const qos::Topic& topic);

 private:
  std::int64_t answered_ns_ = 0;  ///< when all nodes had confirmed, or it was last due
};

/// A device session from the view of one node. The loop writes, the monitor reads.
class Session {
 public:
  /// Called by the loop after the reset and after latched values have been published.
  void begin(std::uint64_t id) noexcept {
    count_.fetch_add(1, std::memory_order_relaxed);
    id_.store(id, std::memory_order_release);
  }
  void stop() noexcept { stopped_.store(true, std::memory_order_release); }

  /// Reports session, state and number of sessions for every node except the device.
  /// Without a session, the node is ready when every link except those to the device has matched.
  /// In a session it is ready once the session has begun and, in lockstep, every link has matched.
  /// It is running once `busy`. Returns the condition that it waits for (`first` until a session
  /// begins), or an empty text. One thread.
  std::string report_to(NodeReport& report, const NodeOptions& options,
                        const NodeRegistry& registry, const std::vector<Link>& links,
                        std::string_view first, bool busy);
  std::uint64_t id() const noexcept { return id_.load(std::memory_order_acquire); }
  bool stopped() const noexcept { return stopped_.load(std::memory_order_acquire); }

 private:
  std::atomic<std::uint64_t> id_{0}, count_{0};
  std::atomic<bool> stopped_{false};
  PeerSet lockstep_peers_{{"device", "rendering", "coupling", "logger", "validator"}};
};

}  // namespace voxtouch::runtime

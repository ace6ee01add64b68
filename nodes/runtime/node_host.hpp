#pragma once
/// Shared parts of all nodes: participant, wait set, links, session, heartbeat, monitor thread,
/// real-time set-up and the loop of the nodes that answer samples.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "nodes/bus/followed_reader.hpp"
#include "nodes/bus/latched_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/node_monitor.hpp"
#include "nodes/runtime/participation.hpp"
#include "nodes/runtime/status_text.hpp"

namespace voxtouch::runtime {

/// Reports that no force is displayed because scene and device are incompatible. Does nothing if
/// `refusal` is empty.
inline void report_refusal(const std::string& refusal, NodeReport& report, StatusText& status) {
  if (refusal.empty())
    return;
  report.state = NodeState::kFailed;
  report.values[kRefusal] = refusal;
  status.set(StatusPriority::kRefused, refusal + " No force is commanded.");
}

/// A node that answers each In with an Out.
/// The loop's thread calls all methods except `report`. Methods marked real-time safe may block in
/// a tap.
template <class In, class Out>
struct Step {
  virtual ~Step() = default;
  /// Takes latched messages and begins the session that they name. In lockstep it is also called
  /// for each sample, because messages that are valid from that sample have arrived by then.
  virtual void listen() = 0;
  /// Whether a sample of the session can be answered. Real-time safe.
  virtual bool ready() const noexcept = 0;
  /// The answer to one sample, or nothing if there is no answer. Real-time safe.
  virtual std::optional<Out> step(const In& in) noexcept = 0;
  /// Called after the answer has been written. Real-time safe.
  virtual void wrote(const In&, const Out&) noexcept {}
  /// Called in a cycle without an answer. `since_ns`: time since the last answer. Real-time safe.
  virtual void idle(std::int64_t /*since_ns*/) noexcept {}
  /// Called after the last cycle.
  virtual void end() {}
  /// Called by the monitor thread: adds values, figures and sentences to the status.
  virtual void report(NodeRegistry& registry, NodeReport& report, StatusText& status) = 0;
};

class NodeHost {
 public:
  enum class Kind : std::uint8_t {
    kLoop,
    kTap,  ///< never delays the ring; after the stop it processes the messages that have arrived
  };
  using Report = std::function<void(NodeRegistry&, NodeReport&, StatusText&)>;

  /// `options` must outlive the host. Throws bus::Error and security::Error.
  NodeHost(const std::string& node, const NodeOptions& options, Kind kind = Kind::kLoop)
      : NodeHost(node, options, bus::Participant(options.participant(node)), kind) {}
  NodeHost(std::string node, const NodeOptions& options, bus::Participant participant,
           Kind kind = Kind::kLoop)
      : node_(std::move(node)),
        options_(options),
        kind_(kind),
        participant_(std::move(participant)),
        wait_set_(participant_) {}

  const NodeOptions& options() const noexcept { return options_; }
  const bus::Participant& participant() const noexcept { return participant_; }
  bus::WaitSet& wait_set() noexcept { return wait_set_; }
  std::vector<Link>& links() noexcept { return links_; }
  const std::vector<Link>& links() const noexcept { return links_; }
  Heartbeat& heartbeat() noexcept { return heartbeat_; }
  Session& session() noexcept { return session_; }

  /// Creates endpoints of this rig, with the QoS profile of the time mode.
  template <class Reader>
  Reader reader(const qos::Topic& topic) const {
    if constexpr (std::is_constructible_v<Reader, const bus::Participant&, const qos::Topic&,
                                          std::string_view>)
      return {participant_, topic, options_.rig};
    else
      return {participant_, topic, options_.rig, qos::profile_in(topic, options_.mode())};
  }
  template <class T>
  bus::Writer<T> writer(const qos::Topic& topic) const {
    return {participant_, topic, options_.rig, qos::profile_in(topic, options_.mode())};
  }
  /// Makes the loop wait for this reader's samples, and readiness depend on its matches. The
  /// endpoint must not move.
  template <class Reader>
  void link_reader(const qos::Topic& topic, const Reader& reader) {
    wait_set_.attach(reader.condition());
    links_.push_back(link_of_reader(topic, reader));
  }
  template <class Writer>
  void link_writer(const qos::Topic& topic, const Writer& writer) {
    links_.push_back(link_of_writer(topic, writer));
  }

  /// Called by the loop: samples of this session are answered from now on. A new session restarts
  /// the sample count.
  void begin_session(std::uint64_t session) noexcept {
    if (session != session_in_loop_)
      next_sample_ = 0;
    session_in_loop_ = session;
    last_sample_.reset();
  }
  std::uint64_t session_in_loop() const noexcept { return session_in_loop_; }
  /// The first sample of the session that has not been answered.
  std::uint64_t next_sample() const noexcept { return next_sample_; }
  /// Whether a stop was requested, or a lockstep peer was lost. Real-time safe.
  bool over() const noexcept { return stop_->load(std::memory_order_relaxed) || peer_lost(); }

  bool peer_lost() const noexcept { return monitor_->peer_lost(); }
  /// In lockstep: waits while `holds()`, in sleeps of 0.2 ms, until a stop.
  template <class Holds>
  void sleep_while(Holds&& holds) noexcept {
    for (; holds() && !over(); sleep_until(monotonic_ns() + 200'000))
      heartbeat_.beat();
  }

  /// Called by the monitor thread: Session::report_to with the links of this node.
  std::string report_session(const NodeRegistry& registry, NodeReport& report,
                             std::string_view first, bool busy) {
    return session_.report_to(report, options_, registry, links_, first, busy);
  }
  /// Whether the latched value of `topic` must be written again; always false in lockstep.
  bool must_repeat(const NodeRegistry& registry, std::uint64_t session, const qos::Topic& topic) {
    return !options_.lockstep && republish_timer_.is_due(registry, session, topic);
  }

  /// Runs `loop` with real-time scheduling while a monitor thread publishes the status; the last
  /// status is published after the loop. `stalls`: signs that must not stall; empty for the host's
  /// heartbeat. Returns 1 if a lockstep peer was lost, else 0.
  int monitored(const std::atomic<bool>& stop, const Report& report,
                const std::function<void()>& loop, std::vector<Watched> stalls = {});
  /// Publishes why the node cannot start.
  void report_failure(const std::string& message) const;

  /// The common loop: wait, take, check session and number, step, write.
  template <class In, class Out>
  int run(Step<In, Out>& node, bus::FollowedReader<In>& in, bus::Writer<Out>& out,
          const std::atomic<bool>& stop) {
    const auto report = [&node](NodeRegistry& registry, NodeReport& status, StatusText& text) {
      node.report(registry, status, text);
    };
    return monitored(stop, report, [&] {
      for (bool last = false; !last;) {
        heartbeat_.beat();
        last = over();
        if (last && kind_ == Kind::kLoop)
          break;
        // Polls, because no message announces that the monitor has bound a participant.
        wait_set_.wait(last                                    ? 100'000'000
                       : session_in_loop_ != 0 && node.ready() ? 50'000'000
                                                               : 5'000'000);
        node.listen();
        In sample;
        bool answered = false;
        for (int n = 0; n < in.kMaxTakes && (kind_ == Kind::kTap || !over()) && in.take(sample);
             ++n)
          answered |= answer(node, sample, out);
        if (!answered)
          node.idle(monotonic_ns() - last_step_ns_);
      }
      node.end();
      session_.stop();
    });
  }

 private:
  template <class In, class Out>
  bool answer(Step<In, Out>& node, const In& sample, bus::Writer<Out>& out) {
    heartbeat_.beat();
    if (options_.lockstep)
      node.listen();
    if (session_in_loop_ == 0 || sample.session_id != session_in_loop_ || !node.ready())
      return false;
    // In lockstep, a write that DDS could not finish in time is repeated, so some readers receive
    // it twice. Only the last number is dropped: a forged number must not suppress the samples that
    // follow.
    if (options_.lockstep && last_sample_ == sample.sequence_number)
      return false;
    last_sample_ = sample.sequence_number;
    next_sample_ = std::max(next_sample_, sample.sequence_number + 1);
    last_step_ns_ = monotonic_ns();
    const std::optional<Out> answer = node.step(sample);
    if (!answer)
      return true;
    out.write_until(*answer, [this] {
      heartbeat_.beat();
      return !options_.lockstep || over();
    });
    node.wrote(sample, *answer);
    return true;
  }

  const std::string node_;
  const NodeOptions& options_;
  const Kind kind_;
  const bus::Participant participant_;
  bus::WaitSet wait_set_;
  std::vector<Link> links_;
  Heartbeat heartbeat_;
  Session session_;
  RepublishTimer republish_timer_;
  std::uint64_t session_in_loop_ = 0, next_sample_ = 0;
  std::optional<std::uint64_t> last_sample_;
  std::int64_t last_step_ns_ = 0;
  const std::atomic<bool>* stop_ = nullptr;
  const NodeMonitor* monitor_ = nullptr;
};

}  // namespace voxtouch::runtime

#pragma once
/// What all nodes share: participant, wait set, links, session, heartbeat, monitor thread,
/// real-time set-up, and the loop of those that answer samples.
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

/// No force: why scene and device do not go together; empty: they do.
inline void report_refusal(const std::string& refusal, NodeReport& report, StatusText& status) {
  if (refusal.empty())
    return;
  report.state = NodeState::kFailed;
  report.values[kRefusal] = refusal;
  status.say(StatusPriority::kRefused, refusal + " No force is commanded.");
}

/// A node that answers each In with an Out. All but `report` are called in the loop's thread. What
/// is marked real-time safe need not be in a tap.
template <class In, class Out>
struct Step {
  virtual ~Step() = default;
  /// Takes latched messages, and begins the session that they name. In lockstep also before each
  /// sample: what holds from a sample on has arrived before it.
  virtual void listen() = 0;
  /// Whether a sample of the session can be answered. Real-time safe.
  virtual bool ready() const noexcept = 0;
  /// The answer to one sample; none: it is not answered. Real-time safe.
  virtual std::optional<Out> step(const In& in) noexcept = 0;
  /// The answer has been written. Real-time safe.
  virtual void wrote(const In&, const Out&) noexcept {}
  /// No sample was answered in this cycle, nor for `since_ns`. Real-time safe.
  virtual void idle(std::int64_t /*since_ns*/) noexcept {}
  /// After the last cycle.
  virtual void end() {}
  /// In the monitor's thread: values, figures and sentences of the status.
  virtual void report(NodeRegistry& registry, NodeReport& report, StatusText& status) = 0;
};

class NodeHost {
 public:
  enum class Kind : std::uint8_t {
    kLoop,
    kTap,  ///< never takes time from the ring; after the stop it handles what has arrived
  };
  using Report = std::function<void(NodeRegistry&, NodeReport&, StatusText&)>;

  /// `options` outlive the host. Throws bus::Error and security::Error.
  NodeHost(std::string node, const NodeOptions& options, Kind kind = Kind::kLoop)
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

  /// Endpoints of this rig, with the profile of the time mode.
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
  /// The loop waits for its samples, and the node is ready when it has matched. The endpoint keeps
  /// its address.
  template <class Reader>
  void link_reader(const qos::Topic& topic, const Reader& reader) {
    wait_set_.attach(reader.condition());
    links_.push_back(link_of_reader(topic, reader));
  }
  template <class Writer>
  void link_writer(const qos::Topic& topic, const Writer& writer) {
    links_.push_back(link_of_writer(topic, writer));
  }

  /// In the loop: samples of this session are answered from here on, counted anew where it is
  /// another one.
  void begin_session(std::uint64_t session) noexcept {
    if (session != session_in_loop_)
      next_sample_ = 0;
    session_in_loop_ = session;
    last_sample_.reset();
  }
  std::uint64_t session_in_loop() const noexcept { return session_in_loop_; }
  /// The first sample of the session that has not been answered.
  std::uint64_t next_sample() const noexcept { return next_sample_; }
  /// Asked to stop, or in lockstep a peer is lost. Real-time safe.
  bool over() const noexcept { return stop_->load(std::memory_order_relaxed) || peer_lost(); }

  bool peer_lost() const noexcept { return monitor_->peer_lost(); }
  /// In lockstep: the loop waits while `holds()`, in sleeps of 0.2 ms, until it is over.
  template <class Holds>
  void sleep_while(Holds&& holds) noexcept {
    for (; holds() && !over(); sleep_until(monotonic_ns() + 200'000))
      heartbeat_.beat();
  }

  /// In the monitor's thread: Session::report_to with this node's links.
  std::string report_session(const NodeRegistry& registry, NodeReport& report,
                             std::string_view first, bool busy) {
    return session_.report_to(report, options_, registry, links_, first, busy);
  }
  /// Whether the latched value of `topic` has to be written again; never in lockstep.
  bool must_repeat(const NodeRegistry& registry, std::uint64_t session, const qos::Topic& topic) {
    return !options_.lockstep && republish_timer_.is_due(registry, session, topic);
  }

  /// Runs `loop` in real time while a monitor thread publishes the status, whose last one is made
  /// after it. `stalls`: what must not stand still; none: the host's heartbeat. Returns 1 where a
  /// lockstep peer was lost, else 0.
  int monitored(const std::atomic<bool>& stop, const Report& report,
                const std::function<void()>& loop, std::vector<Watched> stalls = {});
  /// Publishes why the node cannot start.
  void report_failure(const std::string& message) const;

  /// The one loop: wait, take, check session and number, step, write.
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
        // No message reports that the monitor has bound a participant.
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
    // In lockstep a write that DDS could not end in time is made again, and who had it has it
    // twice. No other number is dropped: a forged one must not suppress those that follow.
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

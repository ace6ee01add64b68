#include "nodes/logger/logger_node.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/bus/latched_reader.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/logger/recorded_topics.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/held_start.hpp"
#include "nodes/runtime/housekeeping.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "nodes/runtime/standby.hpp"

namespace voxtouch::logger {
namespace {

constexpr std::int64_t kMaxStopNs = 1'000'000'000;

std::unique_ptr<bag::BagSink> open_bag(const std::filesystem::path& folder,
                                       const RecordFormat& format) {
  constexpr double kMax = 9e18;  // as whole numbers
  auto writer = bag::BagWriter::create(
      folder,
      {.storage = format.storage,
       .split = {.bytes = static_cast<std::uint64_t>(std::min(format.split_mb * 1e6, kMax)),
                 .time_ns = static_cast<std::int64_t>(std::min(format.split_s * 1e9, kMax))}});
  if (!writer)
    throw std::runtime_error(writer.error().sentence);
  return std::make_unique<bag::BagWriter>(std::move(*writer));
}

class LoggerNode {
 public:
  explicit LoggerNode(const Options& options)
      : options_(options),
        participant_(options.participant("logger")),
        descriptions_(participant_, qos::kDeviceDescription, options.rig),
        wait_set_(participant_),
        recorder_(open_bag(options.bag, options.format), {.lockstep = options.lockstep}),
        topics_(participant_, options, options.topics, recorder_, wait_set_),
        device_("device", {&descriptions_.following()}),
        rendering_("rendering", topics_.of_rendering()),
        links_(topics_.links()) {
    wait_set_.attach(descriptions_.condition());
  }

  int run(const std::atomic<bool>& stop) {
    {
      runtime::Housekeeping housekeeping(
          participant_, "logger", options_,
          [this](runtime::NodeRegistry& registry, runtime::NodeReport& report) {
            look(registry, report);
          },
          {{"its loop", [this] { return heartbeat_.sign(); }},
           {"its disk", [this] { return recorder_.disk_steps() + closing_.sign(); }}});
      record(stop, housekeeping);
      record_what_is_on_its_way();
      topics_.end();
      lost_peer_ = housekeeping.peer_lost();
      constexpr std::int64_t kMaxCloseNs = 20'000'000'000;  // as long as `up` waits for it
      const runtime::Heartbeat::Busy busy(heartbeat_, kMaxCloseNs), closing(closing_, kMaxCloseNs);
      final_ = recorder_.stop();
      session_.stop();  // what is final is in place
    }
    for (const std::string& error : final_.errors)
      log::tell("error: logger: {}\n", error);
    for (const bag::TopicReport& t : final_.topics)
      if (t.dropped + t.lost > 0)
        log::tell(
            "warning: logger: {} of {} messages of {} are not in the bag: the disk was too slow or "
            "full\n",
            t.dropped + t.lost, t.received, t.name);
    return lost_messages(final_) == 0 && final_.errors.empty() && !lost_peer_ ? 0 : 1;
  }

 private:
  /// Until it is asked to stop, or in lockstep a peer is lost.
  void record(const std::atomic<bool>& stop, const runtime::Housekeeping& housekeeping) {
    std::int64_t last_discovery = 0;
    while (!stop.load(std::memory_order_relaxed) && !housekeeping.peer_lost()) {
      heartbeat_.beat();
      wait_set_.wait(20'000'000);
      descriptions_.take([this](const msg::DeviceDescription& d) {
        session_.begin(d.session_id);
        session_in_bag_.store(d.session_id, std::memory_order_relaxed);
      });
      topics_.drain();
      if (const std::int64_t now = runtime::monotonic_ns(); now - last_discovery > 50'000'000) {
        last_discovery = now;
        for (const std::string& sentence : topics_.discover())
          log::tell("warning: logger: {}\n", sentence);
      }
    }
  }

  /// Whatever the others wrote before they stopped has been acknowledged by our readers: it is
  /// here, or on its way (best effort). Not for ever: others may go on writing, a ring that this
  /// logger only listens to or a robot whose topics it was told. Quiet is counted in waits and not
  /// by the clock: a machine that lets this process wait lets DDS's threads in it wait as well.
  void record_what_is_on_its_way() {
    const std::int64_t end = runtime::monotonic_ns() + kMaxStopNs;
    for (int quiet = 0; quiet < 5 && runtime::monotonic_ns() < end;
         quiet = wait_set_.wait(20'000'000) ? 0 : quiet + 1) {
      heartbeat_.beat();
      descriptions_.take([](const msg::DeviceDescription&) {});
      topics_.drain();
    }
  }

  static std::uint64_t lost_messages(const bag::RecordingReport& report) {
    return report.total(&bag::TopicReport::dropped) + report.total(&bag::TopicReport::lost);
  }

  void look(runtime::NodeRegistry& registry, runtime::NodeReport& report) {
    const bool finished = session_.stopped();
    const bag::RecordingReport now = finished ? final_ : recorder_.report();
    const std::uint64_t lost = lost_messages(now);
    report.message = !now.errors.empty() ? now.errors.front()
                     : lost              ? "the disk is too slow: messages are being dropped"
                     : finished          ? "the bag is closed"
                                         : "recording";
    report.values = {{"bag", options_.bag.string()}};
    report.figures = {{"received", {now.total(&bag::TopicReport::received), "messages"}},
                      {"written", {now.total(&bag::TopicReport::written), "messages"}},
                      {"dropped", {lost, "messages"}},
                      {"topics", {now.topics.size(), "topics"}}};
    topics_.tell(session_in_bag_.load(std::memory_order_relaxed), report.figures);
    device_.update(registry, std::nullopt);
    look_for_rendering(registry, report);
    session_.report_to(report, options_, registry, links_, "a device", true);
  }

  /// Of two that play it both are entitled: the one that stands by writes no record before it acts.
  void look_for_rendering(const runtime::NodeRegistry& registry, runtime::NodeReport& report) {
    if (device_.bound())
      rendering_.update(registry, device_.session());
    RoleRecords& records = topics_.records();
    const auto& acting = rendering_.participant();
    if (acting)
      records.entitle(*acting);
    const runtime::NodeReport* said = acting ? registry.report_of(*acting) : nullptr;
    if (const auto standby = said ? runtime::named_standby(*said).participant : std::nullopt)
      records.entitle(*standby);
    records.looked(acting.has_value());
    const std::uint64_t refused = records.refused();
    report.figures["records"] = {records.settled(), "messages"};
    report.figures["refused_records"] = {refused, "messages"};
    if (refused == 0)
      return;
    std::string names;
    for (const bus::Guid& writer : records.refused_writers())
      names += (names.empty() ? "" : " and ") +
               (writer == bus::Guid{} ? "somebody who has gone" : registry.name_of(writer));
    report.message += fmt::format(
        "; {} records that {} wrote are not in the bag: only the rendering's are, and {}", refused,
        names, acting ? "that is " + registry.name_of(*acting) : "none is known");
  }

  const Options& options_;
  bus::Participant participant_;
  bus::LatchedReader<msg::DeviceDescription> descriptions_;
  bus::WaitSet wait_set_;
  bag::BagRecorder recorder_;
  RecordedTopics topics_;
  runtime::RoleBinding device_;  ///< whose session this is; what is recorded is all that is on the
                                 ///< wire, but for records that a replay follows
  runtime::RoleBinding rendering_;  ///< whose records those are
  std::vector<runtime::Link> links_;
  bag::RecordingReport final_;
  runtime::Session session_;
  std::atomic<std::uint64_t> session_in_bag_{0};
  runtime::Heartbeat heartbeat_, closing_;
  bool lost_peer_ = false;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  if (!runtime::may_begin(stop))
    return 0;
  LoggerNode node(options);
  return node.run(stop);
}

}  // namespace voxtouch::logger

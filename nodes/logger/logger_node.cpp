#include "nodes/logger/logger_node.hpp"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/console/log.hpp"
#include "nodes/logger/recorded_topics.hpp"
#include "nodes/runtime/node_host.hpp"
#include "nodes/runtime/participant_counts.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::logger {
namespace {

constexpr std::int64_t kMaxStopNs = 1'000'000'000;

std::unique_ptr<bag::BagSink> open_bag(const Options& options) {
  const RecordFormat& format = options.format;
  constexpr double kMax = 9e18;  // as whole numbers
  auto writer = bag::BagWriter::create(
      options.bag,
      {.storage = format.storage,
       .split = {.bytes = static_cast<std::uint64_t>(std::min(format.split_mb * 1e6, kMax)),
                 .time_ns = static_cast<std::int64_t>(std::min(format.split_s * 1e9, kMax))},
       .folder_is_made = options.bag_is_made});
  if (!writer)
    throw std::runtime_error(writer.error().sentence);
  return std::make_unique<bag::BagWriter>(std::move(*writer));
}

class LoggerNode {
 public:
  explicit LoggerNode(const Options& options)
      : options_(options),
        host_("logger", options, runtime::NodeHost::Kind::kTap),
        descriptions_(
            host_.reader<bus::LatchedReader<msg::DeviceDescription>>(qos::kDeviceDescription)),
        recorder_(open_bag(options), {.lockstep = options.lockstep}),
        topics_(host_.participant(), options, options.topics, recorder_, host_.wait_set()),
        roles_{runtime::RoleBinding{"device", {&descriptions_.following()}},
               runtime::RoleBinding{"rendering", topics_.readers_of("rendering")},
               runtime::RoleBinding{"coupling", topics_.readers_of("coupling")}} {
    host_.links() = topics_.links();
    host_.wait_set().attach(descriptions_.condition());
  }

  int run(const std::atomic<bool>& stop) {
    const auto report = [this](auto& registry, auto& status, auto& text) {
      this->report(registry, status, text);
    };
    const int peer_lost = host_.monitored(
        stop, report, [this] { record(); },
        {{"its loop", [this] { return host_.heartbeat().sign(); }},
         {"its disk", [this] { return recorder_.disk_steps() + closing_.sign(); }}});
    for (const std::string& error : final_.errors)
      console::log("error: logger: {}\n", error);
    for (const bag::TopicReport& t : final_.topics)
      if (t.dropped + t.lost > 0)
        console::log("warning: logger: {} of {} messages of {} dropped: {}\n", t.dropped + t.lost,
                     t.received, t.name,
                     final_.errors.empty() ? "the disk is too slow" : "see the error above");
    return lost_messages(final_) == 0 && final_.errors.empty() ? peer_lost : 1;
  }

 private:
  void record() {
    std::int64_t last_discovery = 0;
    while (!host_.over()) {
      host_.heartbeat().beat();
      host_.wait_set().wait(20'000'000);
      descriptions_.take([this](const msg::DeviceDescription& d) {
        host_.session().begin(d.session_id);
        session_in_bag_.store(d.session_id, std::memory_order_relaxed);
      });
      topics_.drain();
      if (const std::int64_t now = runtime::monotonic_ns(); now - last_discovery > 50'000'000) {
        last_discovery = now;
        for (const std::string& sentence : topics_.discover())
          console::log("warning: logger: {}\n", sentence);
      }
    }
    record_pending();
    topics_.end();
    constexpr std::int64_t kMaxCloseNs = 20'000'000'000;  // the time that `up` waits for it
    const runtime::Heartbeat::Busy busy(host_.heartbeat(), kMaxCloseNs),
        closing(closing_, kMaxCloseNs);
    final_ = recorder_.stop();
    host_.session().stop();  // the final values are set
  }

  /// Records the messages that other nodes wrote until they stopped. Our readers have acknowledged
  /// the reliable ones; best-effort ones may still be in transit. The time is limited, because
  /// other writers may continue: a ring that is only recorded, or a robot with listed topics.
  /// Silence is counted in waits and not by the clock, because a machine that suspends this process
  /// suspends its DDS threads too.
  void record_pending() {
    const std::int64_t end = runtime::monotonic_ns() + kMaxStopNs;
    for (int quiet = 0; quiet < 5 && runtime::monotonic_ns() < end;
         quiet = host_.wait_set().wait(20'000'000) ? 0 : quiet + 1) {
      host_.heartbeat().beat();
      descriptions_.take([](const msg::DeviceDescription&) {});
      topics_.drain();
    }
  }

  static std::uint64_t lost_messages(const bag::RecordingReport& report) {
    return report.total(&bag::TopicReport::dropped) + report.total(&bag::TopicReport::lost);
  }

  void report(runtime::NodeRegistry& registry, runtime::NodeReport& report,
              runtime::StatusText& status) {
    using runtime::StatusPriority;
    const bool finished = host_.session().stopped();
    const bag::RecordingReport now = finished ? final_ : recorder_.report();
    const std::uint64_t lost = lost_messages(now);
    status.set(StatusPriority::kProgress, finished ? "the bag is closed" : "recording");
    if (lost)
      status.set(StatusPriority::kNetwork, "messages are being dropped: the disk is too slow");
    if (!now.errors.empty())
      status.set(StatusPriority::kFault, now.errors.front());
    report.values = {{"bag", options_.bag.string()}};
    report.figures = {{"received", {now.total(&bag::TopicReport::received), "messages"}},
                      {"written", {now.total(&bag::TopicReport::written), "messages"}},
                      {"dropped", {lost, "messages"}},
                      {"topics", {now.topics.size(), "topics"}}};
    topics_.publish_figures(session_in_bag_.load(std::memory_order_relaxed), report.figures);
    report_roles(registry, report, status);
    host_.report_session(registry, report, "a device", true);
  }

  /// Reports the participants in the roles device, rendering and coupling; only their messages are
  /// recorded.
  void report_roles(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                    runtime::StatusText& status) {
    constexpr std::string_view kRoles[] = {"device", "rendering", "coupling"};
    roles_[0].update(registry, std::nullopt);
    for (std::size_t n = 1; n < roles_.size() && roles_[0].bound(); ++n)
      roles_[n].update(registry, roles_[0].session());
    std::uint64_t settled = 0, refused = 0, skipped = 0;
    std::map<bus::Guid, std::uint64_t> refused_of;
    for (const RecordedTopics::OfRole& one : topics_.of_roles()) {
      const auto& bound =
          roles_[static_cast<std::size_t>(std::ranges::find(kRoles, one.role) - kRoles)]
              .participant();
      if (bound)
        one.records->entitle(*bound);
      one.records->looked(bound.has_value());
      if (one.followed)
        settled += one.records->settled();
      (one.followed ? refused : skipped) += one.records->refused();
      for (const auto& [writer, count] : one.records->refused_writers())
        refused_of[writer] += count;
    }
    for (const auto& [writer, count] : refused_of)
      refused_from_.of(writer) = count;
    refused_from_.name(registry);
    report.figures["records"] = {settled, "messages"};
    report.figures["refused_records"] = {refused, "messages"};
    report.figures["skipped_messages"] = {skipped, "messages"};
    if (refused + skipped == 0)
      return;
    report.values["refused_writers"] = refused_from_.text();
    status.append(fmt::format("; {} messages of unauthorised writers not recorded: {}",
                              refused + skipped, refused_from_.text()));
  }

  const Options& options_;
  runtime::NodeHost host_;
  bus::LatchedReader<msg::DeviceDescription> descriptions_;
  bag::BagRecorder recorder_;
  RecordedTopics topics_;
  std::array<runtime::RoleBinding, 3> roles_;  ///< device of this session, rendering, coupling
  runtime::ParticipantCounts refused_from_;
  bag::RecordingReport final_;
  std::atomic<std::uint64_t> session_in_bag_{0};
  runtime::Heartbeat closing_;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  LoggerNode node(options);
  return node.run(stop);
}

}  // namespace voxtouch::logger

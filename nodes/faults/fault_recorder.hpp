#pragma once
/// Keeps the last two seconds of a loop in memory, and writes them to disk after a fault.
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "nodes/console/log.hpp"
#include "nodes/faults/fault_bag.hpp"
#include "nodes/faults/recent_rows.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/realtime.hpp"

namespace CLI {
class App;
}

namespace voxtouch::faults {

inline constexpr double kRecordedS = 2.0;
/// Further faults are counted but not written, so that a repeating fault cannot fill the disk.
inline constexpr std::uint64_t kMaxRecords = 8;

/// Adds --fault-records DIR.
void add_option(CLI::App& app, std::filesystem::path& folder);

/// Detects faults that another node has recorded since the last poll.
class ReportedFaults {
 public:
  /// Returns true if the report counts more faults than the last one. The count starts at 0.
  bool is_new(const runtime::NodeReport& report) {
    const auto figure = report.figures.find(kFigure);
    const double now = figure == report.figures.end() ? 0.0 : figure->second.value;
    return now > std::exchange(last_, now);
  }
  static constexpr char kFigure[] = "fault_records";

 private:
  double last_ = 0.0;
};

/// The loop pushes and keeps rows; a thread of ordinary priority writes them. Without a folder it
/// does nothing and allocates nothing.
template <class Row>
class FaultRecorder {
 public:
  /// Converts rows to messages; called by the writing thread.
  using Messages = std::function<std::vector<FaultMessage>(const std::vector<Row>&)>;

  FaultRecorder(std::filesystem::path folder, FaultContext context, std::vector<FaultTopic> topics,
                Messages messages)
      : folder_(std::move(folder)),
        context_(std::move(context)),
        topics_(std::move(topics)),
        messages_(std::move(messages)) {
    if (!folder_.empty())
      thread_ = std::jthread([this](const std::stop_token& stop) { write_kept_rows(stop); });
  }

  /// Allocates the rows of kRecordedS. Not for the loop.
  void reserve(double rate_hz) {
    if (!folder_.empty())
      rows_.reserve(static_cast<std::size_t>(std::ceil(kRecordedS * rate_hz)));
  }
  /// Real-time safe. `reason` must have static lifetime; it completes the phrase "before ...".
  void push(const Row& row) noexcept { rows_.push(row); }
  void keep(const char* reason) noexcept {
    if (rows_.keep(reason))
      faults_.fetch_add(1, std::memory_order_relaxed);
  }
  /// The same for a fault that another node has reported. It is not passed on, and is skipped
  /// shortly after a fault of this node.
  void keep_for_reported(const char* reason) noexcept {
    if (rows_.fraction_new() > 0.25)
      rows_.keep(reason);
  }

  /// Reports the number of faults and the folder of the last one. Any thread except the loop's.
  void report_to(runtime::NodeReport& report) const {
    report.figures[ReportedFaults::kFigure] = {faults_.load(std::memory_order_relaxed), "records"};
    const std::lock_guard lock(mutex_);
    if (!last_.empty())
      report.values["fault_record"] = last_;
    if (!diagnostic_.empty())
      report.values["fault_record_error"] = diagnostic_;
  }

 private:
  void write_kept_rows(const std::stop_token& stop) {
    runtime::ordinary_priority();
    for (bool last = false; !last;) {
      last = stop.stop_requested();  // also writes rows that the loop kept at its end
      rows_.take([this](const char* reason, const std::vector<Row>& rows) { write(reason, rows); });
      if (!last)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  void write(const char* reason, const std::vector<Row>& rows) {
    if (++written_ > kMaxRecords)
      return;
    context_.reason = reason;
    std::string where, diagnostic;
    try {
      where = write_fault_bag(folder_, context_, topics_, messages_(rows)).string();
      console::log("{}: fault record of {}: {}\n", context_.node, reason, where);
    } catch (const std::exception& error) {
      diagnostic = fmt::format("cannot write the fault record of {}: {}", reason, error.what());
      console::log("warning: {}: {}\n", context_.node, diagnostic);
    }
    const std::lock_guard lock(mutex_);
    if (!where.empty())
      last_ = std::move(where);
    diagnostic_ = std::move(diagnostic);
  }

  std::filesystem::path folder_;
  FaultContext context_;
  std::vector<FaultTopic> topics_;
  Messages messages_;
  RecentRows<Row> rows_;
  std::atomic<std::uint64_t> faults_{0};
  std::uint64_t written_ = 0;  ///< owned by the thread
  mutable std::mutex mutex_;
  std::string last_, diagnostic_;
  std::jthread thread_;  ///< last member: it uses all others
};

}  // namespace voxtouch::faults

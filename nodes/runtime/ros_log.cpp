#include "nodes/runtime/ros_log.hpp"

#include <utility>

#include <fmt/format.h>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {

RosLog::RosLog(const bus::Participant& participant, const std::string& node, const std::string& rig)
    : lines_(participant, qos::kRosout, rig, qos::profile(qos::kRosout.profile)),
      name_(rig + "." + node) {}

bool RosLog::reader_came() noexcept {
  const std::uint32_t readers = lines_.ever_matched();
  return readers != std::exchange(readers_, readers);
}

void RosLog::write(NodeState state, const std::string& sentence) {
  namespace level = msg::rcl_interfaces_Log_constants;
  if (lines_.matched_count() == 0)
    return;
  const auto [is_printed, skipped] = limiter_.take(monotonic_ns());
  if (!is_printed)
    return;
  const std::string text =
      skipped == 0 ? sentence : fmt::format("{} ({} earlier lines skipped)", sentence, skipped);
  static char none[] = "";
  msg::rcl_interfaces_Log line{};
  line.stamp = to_time(realtime_ns());
  line.level = state == NodeState::kFailed       ? level::kError
               : sentence.starts_with("warning") ? level::kWarn
                                                 : level::kInfo;
  line.name = lend(name_), line.msg = lend(text);
  line.file = line.function = none;
  ++written_;
  lines_.write(line);
}

}  // namespace voxtouch::runtime

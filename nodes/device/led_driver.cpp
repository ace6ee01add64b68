#include "nodes/device/led_driver.hpp"

#include <fmt/format.h>

#include "nodes/runtime/convert.hpp"

namespace voxtouch::device_node {

LedDriver::LedDriver(std::unique_ptr<devices::Driver> driver, const runtime::NodeHost& host,
                     std::uint64_t session)
    : driver_(std::move(driver)),
      session_(session),
      targets_(host.reader<bus::FollowedReader<msg::OperatorTarget>>(qos::kOperatorTarget)),
      page_("page", {&targets_.following()}) {}

devices::DeviceResult<devices::DeviceSample> LedDriver::read(
    std::chrono::microseconds timeout) noexcept {
  msg::OperatorTarget target;
  for (int n = 0; n < targets_.kMaxTakes && targets_.take(target); ++n) {
    if (target.session_id != session_)
      continue;
    driver_->lead_hand(runtime::from_msg(target.pose));
    taken_.fetch_add(1, std::memory_order_relaxed);
  }
  return driver_->read(timeout);
}

void LedDriver::report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                          runtime::StatusText& status) {
  page_.update(registry, session_);
  report.figures["operator_targets"] = {taken_.load(std::memory_order_relaxed), "targets"};
  report.figures["foreign_targets"] = {page_.refused(), "targets"};
  report.values["hand_from"] =
      page_.participant() ? registry.name_of(*page_.participant()) : std::string("no page");
  if (const std::string others = page_.refused_writers(); !others.empty())
    status.set(runtime::StatusPriority::kForeign,
               fmt::format("hand targets from {} are refused: {} moves the hand", others,
                           report.values["hand_from"]));
}

}  // namespace voxtouch::device_node

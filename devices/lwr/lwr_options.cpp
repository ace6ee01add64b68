#include "devices/lwr/lwr_options.hpp"

#include <fmt/format.h>

#include <string_view>

#include "devices/lwr/udp_socket.hpp"

namespace voxtouch::lwr {
namespace {

void require(bool good, std::string_view field, std::string_view rule) {
  if (!good) throw devices::DeviceOpenError(fmt::format("device 'lwr': option {} has to be {}", field, rule));
}
void require_in(double value, double low, double high, std::string_view field) {
  if (!(value >= low && value <= high))
    throw devices::DeviceOpenError(
        fmt::format("device 'lwr': option {} is {}, but has to be in [{}, {}]", field, value, low, high));
}
bool unit(const Quat& q) noexcept { return q.coeffs().allFinite() && std::abs(q.norm() - 1.0) < 1e-6; }

}  // namespace

void LwrOptions::validate() const {
  require(controller.empty() || parse_ipv4(controller), "controller", "an IPv4 address like 192.168.0.20, or empty");
  require_in(connect_timeout_s, 0.0, 3600.0, "connect_timeout_s");
  require_in(silence_s, 0.01, 60.0, "silence_s");
  require_in(max_age_s, 1e-6, 10.0, "max_age_s");
  require_in(virtual_timeout_s, 0.01, 3600.0, "virtual_timeout_s");
  require_in(stop_timeout_s, 0.0, 10.0, "stop_timeout_s");
  require(pose_FT.finite() && unit(pose_FT.orientation), "tool_in_flange",
          "finite, its quaternion of length one");
  require(pose_BD.finite() && unit(pose_BD.orientation), "d_in_base", "finite, its quaternion of length one");
  require(session.start_quality <= fri::Quality::kPerfect, "session.start_quality", "0 to 3");
  require(session.keep_quality <= session.start_quality, "session.keep_quality", "0 to session.start_quality");
  require_in(session.start_timeout_s, 0.01, 3600.0, "session.start_timeout_s");
  require_in(session.pause_s, 0.0, 60.0, "session.pause_s");
  require_in(session.drives_off_grace_s, 0.0, 3600.0, "session.drives_off_grace_s");
  require(session.max_drops > 0, "session.max_drops", "at least 1");
  require_in(composer.joint_damping, 0.0, 1.0, "composer.joint_damping");
  require_in(posture.stiffness_nm_per_rad, 0.0, 200.0, "posture.stiffness_nm_per_rad");
  require_in(posture.damping_nms_per_rad, 0.0, 50.0, "posture.damping_nms_per_rad");
  require_in(posture.max_torque_nm, 0.0, 20.0, "posture.max_torque_nm");
  require_in(posture.min_manipulability, 1e-6, 1.0, "posture.min_manipulability");
  require_in(posture.ramp_s, 0.0, 60.0, "posture.ramp_s");
  require_in(rate_cutoff_hz, 0.1, 1000.0, "rate_cutoff_hz");
  require_in(static_cast<double>(capture_packets), 1.0, 1e7, "capture_packets");
  const LwrLimits limits = lwr_limits();
  for (int i = 0; i < LwrArm::kJoints; ++i) {
    require_in(max_add_torque_nm[i], 0.0, limits.torque_nm[i], fmt::format("max_add_torque_nm[{}]", i));
    require_in(posture.posture[i], -limits.position_rad[i], limits.position_rad[i],
               fmt::format("posture.posture[{}]", i));
  }
}

}  // namespace voxtouch::lwr

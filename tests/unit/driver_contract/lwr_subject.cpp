// The light-weight robot's driver with the simulated controller, which runs on a separate thread.
// This program is linked with sendto wrapped, to observe the datagrams.
#include <fmt/format.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>

#include "devices/lwr/lwr_driver.hpp"
#include "devices/lwr/simulated/session.hpp"
#include "tests/unit/driver_contract/subject.hpp"
#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::contract {
namespace {

using namespace lwr_sim;

/// Decodes the datagrams of this process with the arm's geometry.
class Ears {
 public:
  static Ears& instance() {
    static Ears* const one = new Ears;
    return *one;
  }
  void reset() {
    const std::lock_guard lock(mutex_);
    wire_ = {};
    measured_.fill(lwr::LwrJoints::Zero());
  }
  Wire wire() {
    const std::lock_guard lock(mutex_);
    return wire_;
  }
  void receive(const void* data, std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (size == sizeof(lwr::fri::MsrPacket)) {
      lwr::fri::MsrPacket msr;
      std::memcpy(&msr, data, size);
      if (lwr::fri::measured_finite(msr))
        measured_[msr.header.send_seq % measured_.size()] = lwr::fri::from_wire(msr.data.jnt_pos);
    }
    if (size == sizeof(lwr::fri::CmdPacket)) {
      lwr::fri::CmdPacket cmd;
      std::memcpy(&cmd, data, size);
      judge(cmd);
    }
  }

 private:
  void judge(const lwr::fri::CmdPacket& cmd) {
    ++wire_.orders;
    const lwr::LwrJoints torque = lwr::fri::from_wire(cmd.command.add_jnt_trq);
    if (!lwr::fri::finite(cmd))
      ++wire_.not_finite;
    if (torque.isZero(0.0) || !torque.allFinite())
      return;
    ++wire_.pushes;
    // The posture's torque is at right angles to that of any wrench, so the wrench in it is found
    // by least squares.
    const lwr::LwrArm::State arm = arm_.at(measured_[cmd.header.refl_seq % measured_.size()]);
    const Mat6 square = arm.jacobian * arm.jacobian.transpose();
    const Vec6 wrench = square.ldlt().solve(arm.jacobian * torque);
    wire_.force_n = std::max(wire_.force_n, wrench.head<3>().norm());
    wire_.torque_nm = std::max(wire_.torque_nm, wrench.tail<3>().norm());
    const lwr::LwrJoints limit = lwr::LwrOptions().max_add_torque_nm;
    wire_.drive_ratio =
        std::max(wire_.drive_ratio, (torque.array().abs() / limit.array()).maxCoeff());
  }

  std::mutex mutex_;
  lwr::LwrArm arm_;
  std::array<lwr::LwrJoints, 256> measured_{};
  Wire wire_;
};

/// Delays are those of the usual period of a millisecond, and longer for a longer period.
std::vector<Fault> schedule(const Subject& subject, const FaultCase& fault, double period_s) {
  const std::string_view kind = fault.text.substr(0, fault.text.find(':')),
                         value = fault.text.substr(kind.size());
  Fault parsed = parse_fault(
      fmt::format("{}@{}:{}{}", kind, fault_start_s(subject), fault_lasts_s(subject, fault), value),
      kFaults);
  if (parsed.kind == FaultKind::kLate || parsed.kind == FaultKind::kJitter)
    parsed.value *= period_s / 1e-3;
  return {parsed};
}

class LwrSubject final : public Subject {
 public:
  LwrSubject(bool virtual_time, std::string capture)
      : virtual_time_(virtual_time),
        capture_(std::move(capture)) {
    Ears::instance().reset();
  }
  ~LwrSubject() override {
    close();
    stop_ = true;
    if (thread_.joinable())
      thread_.join();
  }

  std::string name() const override { return "lwr"; }
  bool virtual_time() const override { return virtual_time_; }
  double now_s() override { return now_s_; }
  Wire wire() override { return Ears::instance().wire(); }
  Wrench usual_push() const override { return {Vec3(6.0, -4.0, 5.0), Vec3::Zero()}; }
  double usual_period_s() const override {
    return virtual_time_ ? 0.001 : 0.005;
  }  // a busy machine answers within that
  bool answers_are_final() const override { return virtual_time_; }

 protected:
  std::unique_ptr<devices::Driver> make() override {
    if (!session_)
      start_controller();
    lwr::LwrOptions options;
    options.address = "127.0.0.1";
    options.port = port_;
    options.connect_timeout_s = 5.0;
    options.virtual_timeout_s = fault_ != nullptr && fault_->text == "silent" ? 0.04 : 2.0;
    options.silence_s = 0.1;
    options.capture_file = capture_;
    return std::make_unique<lwr::LwrDriver>(options);
  }
  bool scheduled_faults() const override { return true; }
  void collect(std::vector<Received>& all) override {
    const std::lock_guard lock(mutex_);
    all.insert(all.end(), news_.begin(), news_.end());
    news_.clear();
  }

 private:
  void start_controller() {
    port_ = arm::UdpSocket("127.0.0.1", 0).local().port;
    ControllerConfig config;
    config.virtual_time = virtual_time_;
    config.period_s = usual_period_s();
    const FaultSchedule faults(fault_ ? schedule(*this, *fault_, config.period_s)
                                      : std::vector<Fault>());
    config.torque_delay_ticks = 0;
    config.torque_lag_s = 0.0;
    config.laws.compensates_coriolis = false;  // which would add uncommanded force
    controller_ = std::make_unique<FriController>(
        config, lwr_sim::test::arm_at(Vec3::Zero(), 500.0, 60.0), faults);
    SessionConfig network;
    network.remote_port = port_;
    network.patience_s = 1.0;
    session_ = std::make_unique<Session>(network, *controller_, Line(faults, config.period_s, 1));
    session_->after_period = [this, period = config.period_s](const FriController&) {
      note(period);
    };
    thread_ = std::thread([this] { session_->run(stop_); });
  }
  /// In other states than command mode the controller holds the arm by its own law, and up to the
  /// first answer in command mode as well: no force of ours.
  void note(double period_s) {
    const TraceRow row = controller_->row();
    Received got{row.time_s - period_s, row.time_s, {}};
    ++periods_in_command_;
    if (row.state == lwr::fri::State::kCmd && !row.braked && periods_in_command_ > 1)
      got.wrench = row.applied;
    while (const auto event = controller_->take_event()) {
      if (event->from != lwr::fri::State::kCmd && event->to == lwr::fri::State::kCmd)
        periods_in_command_ = 0, got.wrench = {};
      // Left at the period's end: until then force was as before.
      if (event->from == lwr::fri::State::kCmd && event->time_s > row.time_s - 0.5 * period_s)
        got.wrench = last_.wrench;
    }
    last_ = got;
    now_s_ = row.time_s;
    const std::lock_guard lock(mutex_);
    news_.push_back(got);
  }

  bool virtual_time_;
  std::string capture_;
  std::uint16_t port_ = 0;
  std::unique_ptr<FriController> controller_;
  std::unique_ptr<Session> session_;
  std::atomic<bool> stop_{false};
  std::atomic<double> now_s_{0.0};
  std::mutex mutex_;
  std::vector<Received> news_;
  Received last_;  // this and the next: the thread's
  int periods_in_command_ = 0;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Subject> lwr(bool virtual_time, const std::string& capture) {
  return std::make_unique<LwrSubject>(virtual_time, capture);
}

void lwr_receives(const void* data, std::size_t size) { Ears::instance().receive(data, size); }

}  // namespace voxtouch::contract

extern "C" {
ssize_t __real_sendto(int file, const void* data, std::size_t size, int flags, const sockaddr* to,
                      socklen_t length);
ssize_t __wrap_sendto(int file, const void* data, std::size_t size, int flags, const sockaddr* to,
                      socklen_t length);
ssize_t __wrap_sendto(int file, const void* data, std::size_t size, int flags, const sockaddr* to,
                      socklen_t length) {
  voxtouch::contract::lwr_receives(data, size);
  voxtouch::contract::fr3_receives(data, size);
  return __real_sendto(file, data, size, flags, to, length);
}
}

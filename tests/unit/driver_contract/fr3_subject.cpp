// The Franka arm's driver with the simulated robot, whose server runs on a separate thread.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <array>
#include <atomic>
#include <cstring>
#include <mutex>
#include <thread>

#include "devices/fr3/fr3_driver.hpp"
#include "devices/fr3/simulated/fci_server.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

/// Decodes the datagrams of this process with the arm's geometry.
class Fr3Ears {
 public:
  static Fr3Ears& instance() {
    static Fr3Ears* const one = new Fr3Ears;
    return *one;
  }
  void reset(const fr3::fci::Dialect* dialect) {
    const std::lock_guard lock(mutex_);
    dialect_ = dialect;
    wire_ = {};
    measured_.fill(fr3::fr3_rest_posture());
  }
  Wire wire() {
    const std::lock_guard lock(mutex_);
    return wire_;
  }
  void receive(const void* data, std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (dialect_ == nullptr)
      return;
    const std::span bytes(static_cast<const std::byte*>(data), size);
    fr3::fci::State state;
    if (fr3::fci::decode(*dialect_, bytes, state) == fr3::fci::PacketFault::kNone)
      measured_[state.message_id % measured_.size()] = state.q;
    fr3::fci::Command command;
    const fr3::fci::PacketFault fault = fr3::fci::decode(*dialect_, bytes, command);
    if (fault != fr3::fci::PacketFault::kLength)
      judge(command, fault);
  }

 private:
  void judge(const fr3::fci::Command& command, fr3::fci::PacketFault fault) {
    ++wire_.orders;
    if (fault == fr3::fci::PacketFault::kNotFinite)
      ++wire_.not_finite;
    const arm::Joints& torque = command.torque_nm;
    if (torque.isZero(0.0) || !torque.allFinite())
      return;
    ++wire_.pushes;
    // The posture's torque is at right angles to that of any wrench, so the wrench in it is found
    // by least squares.
    const fr3::Fr3Arm::State arm = arm_.at(measured_[command.message_id % measured_.size()]);
    const Mat6 square = arm.jacobian * arm.jacobian.transpose();
    const Vec6 wrench = square.ldlt().solve(arm.jacobian * torque);
    wire_.force_n = std::max(wire_.force_n, wrench.head<3>().norm());
    wire_.torque_nm = std::max(wire_.torque_nm, wrench.tail<3>().norm());
    const arm::Joints limit = fr3::Fr3Options().max_add_torque_nm;
    wire_.drive_ratio =
        std::max(wire_.drive_ratio, (torque.array().abs() / limit.array()).maxCoeff());
  }

  std::mutex mutex_;
  const fr3::fci::Dialect* dialect_ = nullptr;
  fr3::Fr3Arm arm_;
  std::array<arm::Joints, 256> measured_{};
  Wire wire_;
};

hand::Hand gripping_hand() {
  sim::OperatorConfig config = *hand::grip("arm");
  config.carries_tool = false;
  config.stiffness_n_per_m = 500.0;
  config.damping_ns_per_m = 60.0;
  const Pose tool = fr3::Fr3Arm().at(fr3::fr3_rest_posture()).pose_BT;
  Motion motion;
  motion.path = {tool.position};
  motion.orientation = tool.orientation;
  return hand::Hand(config, motion, fr3_sim::kSubstep);
}

class Fr3Subject final : public Subject {
 public:
  Fr3Subject(bool virtual_time, std::uint16_t version)
      : virtual_time_(virtual_time),
        version_(version) {
    Fr3Ears::instance().reset(fr3::fci::dialect_of(version));
  }
  ~Fr3Subject() override {
    close();
    stop_ = true;
    if (thread_.joinable())
      thread_.join();
    Fr3Ears::instance().reset(nullptr);
  }

  std::string name() const override { return "fr3"; }
  bool virtual_time() const override { return virtual_time_; }
  double now_s() override { return now_s_; }
  Wire wire() override { return Fr3Ears::instance().wire(); }
  Wrench usual_push() const override { return {Vec3(6.0, -4.0, 5.0), Vec3::Zero()}; }
  bool answers_are_final() const override { return true; }
  double fade_s() const override { return 0.007; }  // 5 Nm at the shoulder, 0.95 Nm a command
  int periods_to_reach() const override { return 60; }

 protected:
  std::unique_ptr<devices::Driver> make() override {
    if (!server_)
      start_robot();
    fr3::Fr3Options options;
    options.address = "127.0.0.1";
    options.port = server_->port();
    options.connect_timeout_s = 5.0;
    options.virtual_time = virtual_time_;
    options.virtual_timeout_s =
        fault_ != nullptr && (fault_->text == "silent" || fault_->text == "closed") ? 0.04 : 2.0;
    options.silence_s = 0.1;
    return std::make_unique<fr3::Fr3Driver>(options);
  }
  bool scheduled_faults() const override { return true; }
  void collect(std::vector<Received>& all) override {
    const std::lock_guard lock(mutex_);
    all.insert(all.end(), news_.begin(), news_.end());
    news_.clear();
  }

 private:
  void start_robot() {
    std::vector<fr3_sim::Fault> faults;
    if (fault_) {
      const std::string_view kind = fault_->text.substr(0, fault_->text.find(':')),
                             value = fault_->text.substr(kind.size());
      faults.push_back(parse_fault(fmt::format("{}@{}:{}{}", kind, fault_start_s(*this),
                                               fault_lasts_s(*this, *fault_), value),
                                   fr3_sim::kFaults));
    }
    fr3_sim::RobotConfig config;
    config.version = version_;
    config.torque_delay_ticks = 0;
    config.torque_lag_s = 0.0;
    config.laws.compensates_coriolis = false;      // which would add uncommanded force
    config.limits.speed_rad_s.setConstant(100.0);  // random forces: the driver's limit is tested
    const fr3_sim::FaultSchedule schedule(faults);
    robot_ = std::make_unique<fr3_sim::FciRobot>(config, gripping_hand(), schedule);
    fr3_sim::ServerConfig network;
    network.virtual_time = virtual_time_;
    network.patience_s = 1.0;
    server_ = std::make_unique<fr3_sim::FciServer>(network, *robot_,
                                                   fr3_sim::Line(schedule, fr3_sim::kTick, 1));
    server_->after_period = [this](const fr3_sim::FciRobot& robot) {
      const double now = robot.time_s();
      now_s_ = now;
      const std::lock_guard lock(mutex_);
      news_.push_back({now - fr3_sim::kTick, now, robot.applied()});
    };
    thread_ = std::thread([this] { server_->run(stop_); });
  }

  bool virtual_time_;
  std::uint16_t version_;
  std::unique_ptr<fr3_sim::FciRobot> robot_;
  std::unique_ptr<fr3_sim::FciServer> server_;
  std::atomic<bool> stop_{false};
  std::atomic<double> now_s_{0.0};
  std::mutex mutex_;
  std::vector<Received> news_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Subject> fr3(bool virtual_time, std::uint16_t version) {
  return std::make_unique<Fr3Subject>(virtual_time, version);
}

void fr3_receives(const void* data, std::size_t size) { Fr3Ears::instance().receive(data, size); }

}  // namespace voxtouch::contract

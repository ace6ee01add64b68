// Devices that exist in arithmetic only.
#include "devices/sim/simulated_device.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

class SimulatedSubject final : public Subject {
 public:
  SimulatedSubject(std::string name, const sim::SimParameters& parameters)
      : name_(std::move(name)),
        parameters_(parameters) {
    parameters_.description.delay_s = 0.0;
    parameters_.description.force_bandwidth_hz = std::numeric_limits<double>::infinity();
  }

  std::string name() const override { return name_; }
  bool exclusive() const override { return false; }
  double now_s() override {
    return device_ && opened() ? 1e-9 * static_cast<double>(device_->time_ns()) : last_s_;
  }
  Wire wire() override { return wire_; }
  Wrench usual_push() const override {
    return {Vec3(0.2, -0.1, 0.15) * parameters_.description.max_force_n, Vec3::Zero()};
  }

 protected:
  std::unique_ptr<devices::Driver> make() override {
    Motion rest;
    rest.path = {Vec3::Zero()};
    auto device = std::make_unique<sim::SimulatedDevice>(parameters_, parameters_.hand, rest, 3);
    if (!opened())
      device_ = device.get();
    return device;
  }
  /// The wire is the begin of the force path, which is its end here.
  void observe() override {
    const double now = now_s();
    if (now == last_s_)
      return;
    const Wrench& got = device_->applied();
    received_.push_back({last_s_, now, got});
    last_s_ = now;
    ++wire_.orders;
    if (!got.zero())
      ++wire_.pushes;
    if (!got.finite())
      ++wire_.not_finite;
    wire_.force_n = std::max(wire_.force_n, got.force.norm());
    wire_.torque_nm = std::max(wire_.torque_nm, got.torque.norm());
  }

 private:
  std::string name_;
  sim::SimParameters parameters_;
  sim::SimulatedDevice* device_ = nullptr;
  double last_s_ = 0.0;
  Wire wire_;
};

}  // namespace

std::unique_ptr<Subject> simulated_phantom() {
  return std::make_unique<SimulatedSubject>("sim-phantom", sim::sim_phantom());
}
std::unique_ptr<Subject> simulated_lwr() {
  return std::make_unique<SimulatedSubject>("sim-lwr", sim::sim_lwr());
}

}  // namespace voxtouch::contract

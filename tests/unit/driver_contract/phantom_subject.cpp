// The Phantom's driver with the simulated vendor's library. A function in place of the vendor's
// observes the commands.
#include <dlfcn.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>

#include "devices/phantom/hd_library.hpp"
#include "devices/phantom/phantom_driver.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

std::mutex g_mutex;
Wire g_wire;

void spied_set(phantom::hd::HDenum name, const phantom::hd::HDdouble* values);

/// The library's functions and hooks, loaded once a process.
struct Library {
  static inline const std::string file =
      VOXTOUCH_HD_SIM_LIBRARY;  // GCC 13 and later treat the result as part of a temporary
  const phantom::HdLibrary& library = phantom::HdLibrary::load(file);
  decltype(&hdsim_defaults) defaults = find<decltype(&hdsim_defaults)>("hdsim_defaults");
  decltype(&hdsim_use_virtual_time) use_virtual_time =
      find<decltype(&hdsim_use_virtual_time)>("hdsim_use_virtual_time");
  decltype(&hdsim_set_model) set_model = find<decltype(&hdsim_set_model)>("hdsim_set_model");
  decltype(&hdsim_set_switches) set_switches =
      find<decltype(&hdsim_set_switches)>("hdsim_set_switches");
  decltype(&hdsim_step) step = find<decltype(&hdsim_step)>("hdsim_step");
  decltype(&hdsim_inject) inject = find<decltype(&hdsim_inject)>("hdsim_inject");
  decltype(&hdsim_read_state) read_state = find<decltype(&hdsim_read_state)>("hdsim_read_state");
  void (*set_doublev)(phantom::hd::HDenum, const phantom::hd::HDdouble*) = nullptr;

  Library() {
    auto& api = const_cast<phantom::hd::Api&>(library.api());  // none of it has been called yet
    set_doublev = api.hdSetDoublev;
    api.hdSetDoublev = spied_set;
  }
  template <class F>
  static F find(const char* name) {
    void* const handle = dlopen(VOXTOUCH_HD_SIM_LIBRARY, RTLD_LAZY | RTLD_NOLOAD);
    const F function = reinterpret_cast<F>(handle != nullptr ? dlsym(handle, name) : nullptr);
    if (function == nullptr)
      throw std::runtime_error(std::string("the simulated library has no ") + name);
    return function;
  }
};

Library& sim() {
  static Library* const one = new Library;
  return *one;
}

/// Force in N, torque in mNm.
void spied_set(phantom::hd::HDenum name, const phantom::hd::HDdouble* values) {
  if (name == phantom::hd::kCurrentForce || name == phantom::hd::kCurrentTorque) {
    const Vec3 v(values[0], values[1], values[2]);
    const std::lock_guard lock(g_mutex);
    if (name == phantom::hd::kCurrentForce)
      ++g_wire.orders;
    if (name == phantom::hd::kCurrentForce && !v.isZero(0.0))
      ++g_wire.pushes;
    if (!v.allFinite())
      ++g_wire.not_finite;
    double& largest = name == phantom::hd::kCurrentForce ? g_wire.force_n : g_wire.torque_nm;
    largest = std::max(largest, (name == phantom::hd::kCurrentForce ? 1.0 : 1e-3) * v.norm());
  }
  sim().set_doublev(name, values);
}

class PhantomSubject final : public Subject {
 public:
  PhantomSubject(const std::string& model, bool virtual_time)
      : model_(model),
        virtual_time_(virtual_time) {
    sim().defaults();
    if (sim().use_virtual_time(virtual_time) != 0 || sim().set_model(model.c_str()) != 0)
      throw std::runtime_error("the simulated library cannot be set up: is a device open?");
    const std::lock_guard lock(g_mutex);
    g_wire = {};
  }
  ~PhantomSubject() override {
    close();
    sim().defaults();
  }

  std::string name() const override { return "phantom-" + model_; }
  bool virtual_time() const override { return virtual_time_; }
  double now_s() override { return state().time; }
  Wire wire() override {
    const std::lock_guard lock(g_mutex);
    Wire wire = g_wire;
    wire.not_finite += state().non_finite_sets;
    return wire;
  }
  Wrench usual_push() const override { return {Vec3(1.0, -0.5, 0.8), Vec3::Zero()}; }

 protected:
  std::unique_ptr<devices::Driver> make() override {
    if (fault_ != nullptr && fault_->at_opening)
      sim().inject(fault_->code, fault_->amount);
    phantom::PhantomOptions options;
    options.library = VOXTOUCH_HD_SIM_LIBRARY;
    options.silence_s = 0.1;
    return std::make_unique<phantom::PhantomDriver>(options);
  }
  void observe() override {
    const hdsim_state s = state();
    if (s.time == last_s_)
      return;
    const Vec3 force(s.motor_force[0], s.motor_force[1], s.motor_force[2]);
    received_.push_back({last_s_, s.time, {force, Vec3::Zero()}});
    last_s_ = s.time;
  }
  void pass_period() override {
    if (virtual_time_)
      sim().step();
  }
  void begin_fault(const FaultCase& fault) override { sim().inject(fault.code, fault.amount); }
  void end_fault(const FaultCase& fault) override {
    if (fault.end_amount >= 0.0)
      sim().inject(fault.code, fault.end_amount);
  }

 private:
  static hdsim_state state() {
    hdsim_state s{};
    sim().read_state(&s, sizeof s);
    return s;
  }
  std::string model_;
  bool virtual_time_;
  double last_s_ = 0.0;
};

}  // namespace

std::unique_ptr<Subject> phantom(const std::string& model, bool virtual_time) {
  return std::make_unique<PhantomSubject>(model, virtual_time);
}

}  // namespace voxtouch::contract

#include "tests/support/loop_rig/loop_rig.hpp"

#include <malloc.h>
#include <time.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "core/device_fit/coupling_input.hpp"
#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/fit_coupling.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kValidPeriods = 5.0;  ///< as the coupling node has it

std::unique_ptr<rendering::BuiltScene> build(scene::Scene scene, const RigOptions& ask) {
  scene.contact.stiffness_n_per_m *= ask.stiffness_times,
      scene.contact.stiffness_n_per_m3 *= ask.stiffness_times;
  rendering::BuildChoices choices;
  choices.model = ask.model;
  return rendering::build_scene(scene, serial_for(), choices);
}

device_fit::FittedCoupling fit(const scene::Scene& scene,
                               const coupling::design::DeviceModel& device,
                               const rendering::Plan& plan) {
  device_fit::FittedCoupling fitted =
      device_fit::fit_coupling(scene, device, plan.contact_n_per_m, plan.contact_nm_per_rad);
  if (!fitted.refusal.empty())
    throw std::runtime_error(design_text::sentence_of(fitted.refusal));
  return fitted;
}

}  // namespace

RigFront::RigFront(const scene::Scene& scene, std::unique_ptr<rendering::BuiltScene> built,
                   const coupling::CouplingSpec& spec, const coupling::CouplingLimits& limits,
                   double period_s, double spring_n_per_m, const rendering::Compliance& series)
    : device_(scene.device),
      built_(std::move(built)),
      live_(*built_),
      coupling_(spec, limits, period_s),
      mapping_(scene.device),
      period_s_(period_s) {
  live_.set_spring_target(spring_n_per_m);
  live_.set_series_target(series);
}

Wrench RigFront::answer(const devices::DeviceSample& sample) noexcept {
  if (!begin_ns_)
    begin_ns_ = sample.time_ns;
  const double dt_s = last_ns_ ? static_cast<double>(sample.time_ns - *last_ns_) * 1e-9 : period_s_;
  last_ns_ = sample.time_ns;
  const rendering::ToolState& tool = mapping_.update(sample.pose, sample.twist, sample.buttons);
  frame_ = live_.render(tool, static_cast<double>(sample.time_ns - *begin_ns_) * 1e-9);
  if (clutch_.advance(tool.clutched, dt_s))
    coupling_.reset(clutch_.scaled(out_.wrench));
  out_ = coupling_.step(device_fit::coupling_input(frame_, tool.pose), dt_s);
  return rendering::wrench_to_device(device_, clutch_.of(out_.wrench), tool.pose.orientation);
}

void RigFront::swap_to(std::unique_ptr<rendering::BuiltScene> next) {
  live_.swap_to(*next);
  old_ = std::exchange(built_, std::move(next));
}

LoopRig::LoopRig(const RigOptions& ask)
    : ask_(ask),
      scene_(scene::load_scene(ask.scene)),
      guard_(devices::guard_config(ask.device.description)) {
  const DeviceDescription& d = ask.device.description;
  std::unique_ptr<rendering::BuiltScene> built = build(scene_, ask);
  DeviceDescription simulated = ask.designed_for.value_or(d);
  simulated.simulated = true;
  const coupling::design::DeviceModel model = coupling::design::model_of(simulated);
  const device_fit::FittedCoupling fitted = fit(scene_, model, built->plan());
  spec_ = fitted.spec;
  spring_n_per_m_ = device_fit::spring_n_per_m(
      fitted, scene_, model, {built->plan().contact_n_per_m, built->plan().contact_nm_per_rad});
  series_ =
      device_fit::series_spring(fitted, scene_, model, built->plan().of_contact_alone,
                                {built->plan().contact_n_per_m, built->plan().contact_nm_per_rad});
  limits_ = device_fit::limits_W(scene_.device, coupling::design::model_of(d));
  front_ = std::make_unique<RigFront>(scene_, std::move(built), spec_, limits_, 1.0 / d.rate_hz,
                                      spring_n_per_m_, series_);
  const Motion in_world = ask.path ? *ask.path : scene_.motions.at(ask.motion);
  device_ = std::make_unique<sim::SimulatedDevice>(
      ask.device, ask.hand.value_or(ask.device.hand),
      motion_in_device(in_world, scene_.device.pose_WD, scene_.device.pose_PT,
                       scene_.device.position_scale),
      ask.seed);
}

std::unique_ptr<RigFront> LoopRig::fresh_front() const {
  return std::make_unique<RigFront>(scene_, build(scene_, ask_), spec_, limits_,
                                    1.0 / ask_.device.description.rate_hz, spring_n_per_m_,
                                    series_);
}

std::unique_ptr<rendering::BuiltScene> LoopRig::build_again(double stiffness_times) const {
  RigOptions ask = ask_;
  ask.stiffness_times = stiffness_times;
  return build(scene_, ask);
}

const devices::DeviceSample& LoopRig::read() noexcept {
  sequence_ = next_++;
  if (const auto sample = device_->read(std::chrono::microseconds(0)))
    sample_ = *sample;
  return sample_;
}

LoopRig::Command LoopRig::answer(const devices::DeviceSample& sample,
                                 std::uint64_t sequence) noexcept {
  const double valid_ns = kValidPeriods * 1e9 / ask_.device.description.rate_hz;
  return {sequence, {front_->answer(sample), sample.time_ns + std::llround(valid_ns)}};
}

devices::GateVerdict LoopRig::arrive(const Command& command) noexcept {
  const devices::GateVerdict verdict = gate_.accept(1, 1, command.sequence, sequence_);
  guard_.count(verdict);
  if (verdict == devices::GateVerdict::kAccepted)
    arrived_ = command.input;
  return verdict;
}

const Wrench& LoopRig::finish() noexcept {
  given_ = guard_.pass(arrived_, sample_.time_ns);
  arrived_.reset();
  if (!device_->write(given_))
    ++refused_writes_;
  return given_;
}

const Wrench& LoopRig::step() noexcept {
  read();
  arrive(answer(sample_, sequence_));
  return finish();
}

Memory memory_in_use() {
  std::ifstream in("/proc/self/statm");
  std::int64_t total = 0, resident = 0;
  in >> total >> resident;
  const struct mallinfo2 heap = mallinfo2();
  return {resident * sysconf(_SC_PAGESIZE), static_cast<std::int64_t>(heap.uordblks + heap.hblkhd)};
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace voxtouch::long_runs

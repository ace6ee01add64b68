#include "nodes/coupling/coupling_node.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "core/coupling/coupling.hpp"
#include "core/scene/device_check.hpp"
#include "core/scene/device_mapping.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/coupling/design_message.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/housekeeping.hpp"
#include "nodes/runtime/participation.hpp"

namespace voxtouch::coupling {
namespace {

using runtime::NodeState;
constexpr auto kRelaxed = std::memory_order_relaxed;

class CouplingNode {
 public:
  CouplingNode(const Options& options, const Scene& scene)
      : options_(options), scene_(scene), participant_(options.participant("coupling")),
        descriptions_(participant_, qos::kDeviceDescription, options.rig,
                      qos::profile_in(qos::kDeviceDescription, options.mode())),
        states_(participant_, qos::kDeviceState, options.rig, qos::profile_in(qos::kDeviceState, options.mode())),
        contacts_(participant_, qos::kContactState, options.rig, qos::profile_in(qos::kContactState, options.mode())),
        commands_(participant_, qos::kForceCommand, options.rig, qos::profile_in(qos::kForceCommand, options.mode())),
        designs_(participant_, qos::kCouplingDesign, options.rig,
                 qos::profile_in(qos::kCouplingDesign, options.mode())),
        wait_set_(participant_) {
    wait_set_.attach(descriptions_.condition());
    wait_set_.attach(states_.condition());
    wait_set_.attach(contacts_.condition());
    links_ = {{"device/description", [this] { return descriptions_.matched(); }, {"device"}},
              {"device/state", [this] { return states_.matched(); }, {"device"}},
              {"rendering/contact", [this] { return contacts_.matched(); }, {"rendering"}},
              {"coupling/command", [this] { return commands_.matched(); }, {"device", "logger"}},
              {"coupling/design", [this] { return designs_.matched(); }, {"logger"}}};
  }

  int run(const std::atomic<bool>& stop) {
    runtime::flush_denormals();
    runtime::Housekeeping housekeeping(
        participant_, "coupling", options_,
        [this](runtime::Roster& roster, runtime::NodeReport& report) { look(roster, report); });
    while (!stop.load(kRelaxed)) {
      wait_set_.wait(50'000'000);
      descriptions_.take_each([this](const msg::DeviceDescription& d) { start_session(d); });
      while (turn()) {
      }
    }
    session_.stop();
    return 0;
  }

 private:
  void start_session(const msg::DeviceDescription& device) {
    period_s_ = 1.0 / device.rate_hz;
    // One point alone is the least that any contact shows: a scene that is too stiff even so is refused at once.
    const DeviceFacts facts{device.max_stiffness_n_per_m, period_s_, device.max_force_n};
    const DeviceCheck check = check_device(scene_, facts, scene_.contact.stiffness_n_per_m);
    if (!check.fits()) {
      const std::lock_guard lock(refusal_mutex_);
      refusal_ = check.errors.front();
      coupling_.reset();
      return;
    }
    const double force = scene_.device.force_scale, lever = scene_.device.position_scale;
    coupling_ =
        make_coupling(scene_.coupling, {device.max_force_n / force, device.max_torque_nm * lever / force}, period_s_);
    coupling_->reset({});
    session_in_loop_ = device.session_id;
    last_time_ns_.reset();
    pending_.reset();
    clutched_ = false;
    recent_ = {}, newest_ = {};  // sequence numbers begin again
    stiffness_.store(0.0, kRelaxed);
    publish_design(designs_, scene_.coupling, device.session_id, period_s_);
    max_stiffness_.store(device.max_stiffness_n_per_m, kRelaxed);
    session_.begin(device.session_id);
  }

  /// Joins one contact with its device sample by sequence number. In real time the newest sample must do if its own was lost.
  bool turn() noexcept {
    msg::DeviceState state;
    while (states_.take(state))
      if (state.session_id == session_in_loop_) recent_[state.sequence_number % recent_.size()] = newest_ = state;
    if (!pending_) {
      msg::ContactState contact;
      if (!contacts_.take(contact)) return false;
      if (contact.session_id != session_in_loop_ || !coupling_) return true;
      pending_ = contact;
    }
    const msg::DeviceState& own = recent_[pending_->sequence_number % recent_.size()];
    const bool joined = own.session_id == session_in_loop_ && own.sequence_number == pending_->sequence_number;
    if (!joined && options_.lockstep) return false;
    answer(joined ? own : newest_, *pending_);
    pending_.reset();
    return true;
  }

  void answer(const msg::DeviceState& state, const msg::ContactState& contact) noexcept {
    const double dt_s = last_time_ns_ ? static_cast<double>(contact.sample_time_ns - *last_time_ns_) * 1e-9 : period_s_;
    last_time_ns_ = contact.sample_time_ns;
    follow_clutch(state.buttons);
    CouplingInput input;
    input.contact = runtime::from_msg(contact.wrench);
    input.contact_stiffness_n_per_m = contact.stiffness_bound_n_per_m;
    input.contact_stiffness = runtime::from_msg(contact.stiffness);
    input.tool = runtime::from_msg(contact.tool_pose);
    const Wrench in_world = coupling_->step(input, dt_s);
    const Wrench in_device =
        clutched_ ? Wrench{}
                  : wrench_to_device(scene_.device, in_world, runtime::from_msg(contact.tool_pose).orientation);
    const CouplingStatus status = coupling_->status();

    msg::ForceCommand m{};
    m.session_id = contact.session_id;
    m.sequence_number = contact.sequence_number;
    m.sample_time_ns = contact.sample_time_ns;
    m.valid_until_ns = contact.sample_time_ns + std::llround(kValidPeriods * period_s_ * 1e9);
    m.wrench = runtime::to_msg(in_device);
    m.status = (status.ramping ? msg::force_command::kStatusRamping : 0U) |
               (status.held_input ? msg::force_command::kStatusHeldInput : 0U) |
               (status.clamped ? msg::force_command::kStatusClamped : 0U);
    commands_.write(m);
    samples_.fetch_add(1, kRelaxed);
    if (status.clamped) clamped_.fetch_add(1, kRelaxed);
    faults_.store(coupling_->faults(), kRelaxed);
    if (contact.stiffness_bound_n_per_m > stiffness_.load(kRelaxed))
      stiffness_.store(contact.stiffness_bound_n_per_m, kRelaxed);
  }

  /// While the clutch is pressed the tool stays and the device moves free: no force; the contact fades in again afterwards.
  void follow_clutch(std::uint32_t buttons) noexcept {
    const bool pressed = scene_.device.clutch_button && ((buttons >> *scene_.device.clutch_button) & 1U) != 0;
    if (pressed != clutched_) coupling_->reset({});
    clutched_ = pressed;
  }

  void look(runtime::Roster& roster, runtime::NodeReport& report) {
    report.values = {
        {"scene", scene_.name},
        {"scene_hash", scene_.hash},
        {"samples", fmt::to_string(samples_.load())},
        {"clamped_inputs", fmt::to_string(clamped_.load())},
        {"faults", fmt::to_string(faults_.load())},
        {"stiffness_bound_max_n_per_m", fmt::format("{:.6g}", stiffness_.load())},
        {"stiffness_at_hand_n_per_m", fmt::format("{:.6g}", stiffness_at_hand_n_per_m(scene_, stiffness_.load()))},
        {"device_max_stiffness_n_per_m", fmt::format("{:.6g}", max_stiffness_.load())}};
    const std::string missing = session_.report_to(report, options_, roster, links_, "a device", samples_.load() > 0);
    // The device's limit is held against the total stiffness of the contact, not against one point's.
    const double displayed = stiffness_at_hand_n_per_m(scene_, stiffness_.load());
    report.message = session_.stopped() ? "stopped"
                     : !missing.empty() ? "waiting for " + missing
                     : displayed > max_stiffness_.load()
                         ? fmt::format(
                               "the contact shows up to {:.0f} N/m, more than the device's {:.0f} N/m: lower "
                               "contact.stiffness_n_per_m or coupling.gain",
                               displayed, max_stiffness_.load())
                         : fmt::format("{} runs", scene_.coupling.kind);
    const std::lock_guard lock(refusal_mutex_);
    if (refusal_.empty()) return;
    report.state = NodeState::kFailed;
    report.message = refusal_ + " No force is commanded.";
  }

  /// Two periods for the way round the ring, three that a device holds a command for.
  static constexpr double kValidPeriods = 5.0;
  const Options& options_;
  const Scene& scene_;
  bus::Participant participant_;
  bus::Reader<msg::DeviceDescription> descriptions_;
  bus::Reader<msg::DeviceState> states_;
  bus::Reader<msg::ContactState> contacts_;
  bus::Writer<msg::ForceCommand> commands_;
  bus::Writer<msg::CouplingDesign> designs_;
  bus::WaitSet wait_set_;
  std::vector<runtime::Link> links_;
  std::unique_ptr<Coupling> coupling_;  ///< none while the scene does not fit the device
  std::mutex refusal_mutex_;
  std::string refusal_;
  double period_s_ = 1e-3;
  std::uint64_t session_in_loop_ = 0;
  std::array<msg::DeviceState, 64> recent_{};
  msg::DeviceState newest_{};
  std::optional<msg::ContactState> pending_;
  std::optional<std::int64_t> last_time_ns_;
  bool clutched_ = false;
  std::atomic<std::uint64_t> samples_{0}, clamped_{0}, faults_{0};
  std::atomic<double> stiffness_{0.0}, max_stiffness_{0.0};
  runtime::Session session_;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  const Scene scene = load_scene(options.scene);
  CouplingNode node(options, scene);
  return node.run(stop);
}

}  // namespace voxtouch::coupling

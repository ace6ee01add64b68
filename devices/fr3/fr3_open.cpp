// Opening and closing the Franka arm: the parts of Fr3Driver that may block, throw and allocate.
#include <fmt/format.h>

#include "devices/fr3/fr3_driver.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::fr3 {
namespace {

using namespace std::chrono_literals;

constexpr auto kCancelledEvery = 50ms;
constexpr double kOtherGeometryM = 0.01;  // calibrated and nominal arm differ by millimetres

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(std::llround(s * 1e9));
}

[[noreturn]] void refuse(const std::string& why) {
  throw devices::DeviceOpenError("device 'fr3': " + why);
}

[[noreturn]] void refuse_other_client(const Fr3Options& options) {
  refuse(
      fmt::format("{}:{} is not an FCI server (invalid reply to Connect): check the options "
                  "'address' and 'port'",
                  options.address, options.port));
}

std::string_view version_remedy(std::uint16_t theirs) {
  if (theirs < fci::kOldestVersion)
    return "update the robot's system image (version 3 comes with 3.0)";
  return "this version is not supported: use a newer voxtouch, or a system image with version 10 "
         "(5.9)";
}

}  // namespace

Fr3Driver::Fr3Driver(const Fr3Options& options) : Fr3Driver(options, connect(options)) {}

Fr3Driver::Fr3Driver(const Fr3Options& options, Connected connected)
    : RequestReplyDriver(std::move(connected.socket), options.silence_s, options.virtual_timeout_s),
      options_(options),
      link_(std::move(connected.link)),
      dialect_(connected.dialect),
      arm_(options.pose_FT),
      limits_(fr3_limits()),
      session_(*dialect_, options.session),
      ramp_(options.step_nm, options.max_add_torque_nm),
      next_request_(1) {
  description_ = describe_fr3();
  rotation_DB_ = options.pose_BD.orientation.conjugate();
  virtual_time_ = options.virtual_time;
  received_.store(Clock::now(), std::memory_order_relaxed);
  set_up();
  first_state();
  if (virtual_time_)
    start_in_virtual_time();
}

/// Tries the newest version first; a robot that refuses it reports its own.
Fr3Driver::Connected Fr3Driver::connect(const Fr3Options& options) {
  std::uint16_t version = fci::kNewestVersion;
  for (bool again = false;; again = true) {
    auto link = std::make_unique<FciLink>(options.address, options.port, options.connect_timeout_s,
                                          options.cancelled);
    auto socket = std::make_unique<arm::UdpSocket>(link->own_address(), 0);
    link->send(fci::connect_request(0, version, socket->local().port));
    const auto received = link->wait(options.connect_timeout_s);
    if (!received && link->got_other_bytes())
      refuse_other_client(options);
    if (!received && link->closed())
      refuse(
          fmt::format("the robot at {} closed the connection: another program uses it, or FCI is "
                      "not activated on its web page",
                      options.address));
    if (!received)
      refuse(fmt::format("the robot at {} did not answer within {} s: restart it from its web page",
                         options.address, options.connect_timeout_s));
    const fci::Outcome outcome = fci::connect_outcome(*received);
    const std::uint16_t theirs = fci::version_in(*received);
    const fci::Dialect* dialect = fci::dialect_of(theirs);
    if (outcome == fci::Outcome::kSuccess && dialect)
      return {std::move(link), std::move(socket), dialect};
    if (outcome == fci::Outcome::kWrongVersion && dialect && !again) {
      version = theirs;
      continue;
    }
    if (outcome == fci::Outcome::kUnknown)
      refuse_other_client(options);
    refuse(fmt::format("the robot at {} refused the version: server {}, this driver {}; {}",
                       options.address, theirs, fci::spoken_versions(), version_remedy(theirs)));
  }
}

fci::Received Fr3Driver::answer_to(const fci::Message& message, fci::Request request) {
  link_->send(message);
  while (const auto received = link_->wait(options_.connect_timeout_s))
    if (fci::request_of(*dialect_, received->command) == request)
      return *received;
  refuse(fmt::format("the robot at {} did not answer to {}: restart it from its web page",
                     options_.address, fci::name_of(request)));
}

/// Sets thresholds and load of the robot for all motions.
void Fr3Driver::set_up() {
  const auto set = [this](const fci::Message& message, fci::Request request) {
    const fci::Outcome outcome = fci::outcome_of(*dialect_, request, answer_to(message, request));
    if (outcome != fci::Outcome::kSuccess)
      refuse(fmt::format("the robot refused {}: {}", fci::name_of(request),
                         fci::sentence_of(outcome)));
  };
  set(fci::collision_request(*dialect_, next_request_++, options_.collision),
      fci::Request::kSetCollisionBehavior);
  if (options_.load.mass_kg > 0.0)
    set(fci::load_request(*dialect_, next_request_++, options_.load), fci::Request::kSetLoad);
}

void Fr3Driver::first_state() {
  const auto deadline = Clock::now() + seconds(options_.connect_timeout_s);
  for (;;) {
    const Intake intake = wait_and_take(std::min(deadline, Clock::now() + kCancelledEvery));
    if (options_.cancelled && options_.cancelled->load())
      refuse("cancelled while waiting for the robot");
    if (intake == Intake::kNew)
      break;
    if (intake == Intake::kNothing && Clock::now() >= deadline)
      refuse(
          counts_.malformed > 0
              ? fmt::format("no valid state from {} (version {}): {} datagrams with a length other "
                            "than {} bytes",
                            options_.address, dialect_->version, counts_.malformed,
                            dialect_->state_size)
              : fmt::format("no state within {} s from {} on UDP {}: check this machine's firewall",
                            options_.connect_timeout_s, options_.address,
                            arm::text_of(socket_->local())));
  }
  started_ = true;
  first_id_ = state_.message_id;
  accept();
  if (sample_.pose_valid)
    compare_geometry();
  if (session_.error() != devices::DeviceError::kRecoverable)
    refuse(last_error());
  if (!virtual_time_)
    reply_without_force();
}

/// Compares the robot's pose of its end effector with the geometry of this driver.
void Fr3Driver::compare_geometry() const {
  const Vec3 ours = posture_.flange.position + posture_.flange.orientation * state_.ee_in_flange;
  const double apart = (ours - state_.ee_in_base).norm();
  if (!(apart < kOtherGeometryM))
    refuse(fmt::format(
        "the arm is not an FR3 or a Panda: its end effector is {:.0f} mm off their geometry",
        1e3 * apart));
}

/// Virtual time does not advance meanwhile, so all steps up to torque control are done here.
void Fr3Driver::start_in_virtual_time() {
  const double patience_s = options_.session.start_timeout_s + options_.connect_timeout_s;
  for (double waited_s = 0.0; !(session_.force_allowed() && sample_.pose_valid); waited_s += 1e-3) {
    if (waited_s > patience_s || session_.error() != devices::DeviceError::kRecoverable)
      refuse(fmt::format("the robot in virtual time did not start: {}", last_error()));
    reply_without_force();
    if (wait_and_take(Clock::now() + seconds(options_.virtual_timeout_s)) != Intake::kNew)
      refuse(fmt::format("the robot in virtual time at {} stopped replying during the start",
                         options_.address));
    accept();
  }
  first_id_ = state_.message_id;
  sample_.time_ns = 0;
  fresh_ = true;
}

DeviceDescription describe_fr3() {
  // Class defaults of an arm, for values that the file omits.
  DeviceDescription d = sim::sim_lwr().description;
  d.model = "fr3";
  // The figures and their sources are in deploy/devices/fr3.yaml; a test compares them.
  d.rate_hz = 1000.0;
  d.max_force_n = 60.0;
  d.max_torque_nm = 10.0;
  d.max_stiffness_n_per_m = 3000.0;
  d.mass_min_kg = 2.0, d.mass_max_kg = 5.0;
  d.damping_ns_per_m = 3.0;
  d.coulomb_friction_n = 2.0;
  d.position_resolution_m = 2e-5;
  d.delay_s = 0.002;
  d.force_bandwidth_hz = 60.0;
  d.inertia_min_kg_m2 = 0.05, d.inertia_max_kg_m2 = 0.15;
  d.damping_nms_per_rad = 0.1;
  d.coulomb_friction_nm = 0.0;
  d.max_stiffness_nm_per_rad = 300.0;
  d.consecutive_losses = 2;
  d.grip = "arm";
  derive_slew_limits(d);  // of the guard; the torque steps of the joints (TorqueRamp) are smaller
  return d;
}

Fr3Driver::~Fr3Driver() { disengage(); }

void Fr3Driver::disengage() noexcept {
  stop();
  const auto deadline = Clock::now() + seconds(options_.stop_timeout_s);
  // First the ramp to zero, then StopMove; the last command is zero torque.
  while (session_.listens() && !link_->closed()) {
    const Intake intake = wait_and_take(deadline);
    if (intake == Intake::kNothing)
      return;
    if (intake == Intake::kInvalid)
      continue;
    accept();
    if (ramp_.at_rest() && !ending_) {
      ending_ = true;
      session_.end();
      ask_what_is_due();
    }
    reply_without_force();
  }
}

void Fr3Driver::note() noexcept {
  noted_errors_.store(session_.errors(), std::memory_order_relaxed);
  noted_diagnostic_.store(session_.diagnostic(), std::memory_order_relaxed);
  noted_refusal_.store(session_.refusal(), std::memory_order_relaxed);
  noted_usable_.store(sample_.pose_valid, std::memory_order_relaxed);
  noted_closed_.store(link_->closed(), std::memory_order_relaxed);
}

std::string Fr3Driver::last_error() const {
  if (noted_closed_.load(std::memory_order_relaxed))
    return fmt::format(
        "no force: the robot at {} closed the connection (switched off, FCI deactivated, or web "
        "page in control). Restart",
        options_.address);
  if (silent_.load(std::memory_order_relaxed)) {
    const auto silence = Clock::now() - received_.load(std::memory_order_relaxed);
    return fmt::format("no message from the robot at {} for {:.1f} s. Check power and cable",
                       options_.address, std::chrono::duration<double>(silence).count());
  }
  const fci::Diagnostic diagnostic = noted_diagnostic_.load(std::memory_order_relaxed);
  if (diagnostic == fci::Diagnostic::kNone)
    return noted_usable_.load(std::memory_order_relaxed)
               ? std::string()
               : "no force: the robot's state has NaN, infinity or impossible values. Check its "
                 "web page";
  std::string text(fci::sentence_of(diagnostic));
  if (diagnostic == fci::Diagnostic::kReflex)
    text += fmt::format(" [{}]", fci::words_of(noted_errors_.load(std::memory_order_relaxed)));
  if (diagnostic == fci::Diagnostic::kRefused)
    text += fmt::format(": {}", fci::sentence_of(noted_refusal_.load(std::memory_order_relaxed)));
  return text;
}

}  // namespace voxtouch::fr3

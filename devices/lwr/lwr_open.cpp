// Opening and closing the light-weight robot: the parts of LwrDriver that may block, throw and
// allocate.
#include <fmt/format.h>

#include <fstream>

#include "devices/lwr/lwr_driver.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::lwr {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::string_view, LwrArm::kJoints> kJointNames = {"A1", "A2", "E1", "A3",
                                                                       "A4", "A5", "A6"};

fri::ComposerRules composer_rules(const LwrOptions& options, double period_s) {
  fri::ComposerRules rules = options.composer;
  rules.step_limit_rad = 0.9 * period_s * lwr_limits().velocity_rad_s;
  return rules;
}

LwrOptions checked(const LwrOptions& options) {
  if (!options.capture_file.empty() && !std::ofstream(options.capture_file, std::ios::binary))
    throw devices::DeviceOpenError(
        fmt::format("device 'lwr': cannot write the capture file '{}'", options.capture_file));
  return options;
}

std::string joints_of(unsigned bits) {
  std::string names;
  for (std::size_t i = 0; i < kJointNames.size(); ++i)
    if (bits >> i & 1)
      names += fmt::format("{}{}", names.empty() ? "" : " ", kJointNames[i]);
  return names;
}

constexpr auto kCancelledEvery = 50ms;

std::chrono::nanoseconds seconds(double s) {
  return std::chrono::nanoseconds(std::llround(s * 1e9));
}

}  // namespace

LwrDriver::LwrDriver(const LwrOptions& options)
    : RequestReplyDriver(std::make_unique<UdpSocket>(options.address, options.port),
                         options.silence_s, options.virtual_timeout_s),
      options_(checked(options)),
      capture_(options.capture_file.empty() ? 0 : options.capture_packets),
      arm_(options.pose_FT),
      limits_(lwr_limits()),
      session_(options.session),
      rates_(options.rate_cutoff_hz) {
  rotation_DB_ = options.pose_BD.orientation.conjugate();
  if (!options_.controller.empty())
    controller_.address = parse_ipv4(options_.controller).value();
  connect();
  if (virtual_time_)
    start_in_virtual_time();
  description_ = describe_lwr(1e-9 * static_cast<double>(period_ns_));
}

void LwrDriver::connect() {
  const auto start = Clock::now(), deadline = start + seconds(options_.connect_timeout_s);
  received_.store(start, std::memory_order_relaxed);
  // A first position is needed to mirror it; a measurement of a closed interface belongs to an
  // earlier session.
  for (bool good = false; !good;) {
    const Intake intake = wait_and_take(std::min(deadline, Clock::now() + kCancelledEvery));
    if (options_.cancelled && options_.cancelled->load())
      throw devices::DeviceOpenError("device 'lwr': cancelled while waiting for its controller");
    if (intake == Intake::kNothing && Clock::now() >= deadline)
      throw devices::DeviceOpenError(nothing_came());
    good = intake == Intake::kNew &&
           (msr_.interface.state == fri::State::kMon || msr_.interface.state == fri::State::kCmd);
  }
  steps_ = 0;
  const double period_s = msr_.interface.msr_period_s;
  if (!(period_s > 0.5e-3 && period_s < 0.11))
    throw devices::DeviceOpenError(fmt::format(
        "device 'lwr': the controller at {} announces a period of {} s, valid: 1 to 100 ms",
        text_of(controller_), period_s));
  // Whole microseconds: the float is slightly off.
  period_ns_ = std::llround(period_s * 1e6) * 1000;
  virtual_time_ = msr_.krl.integer[fri::kToIntSimulated] == fri::kVirtualTime;
  composer_.emplace(composer_rules(options_, 1e-9 * static_cast<double>(period_ns_)));
  clock_.emplace(period_ns_, virtual_time_);
  accept();
  if (session_.error() != devices::DeviceError::kRecoverable) {
    reply_without_force();
    throw devices::DeviceOpenError(fmt::format("device 'lwr': {}", status_text()));
  }
  if (!virtual_time_)
    reply_without_force();
}

std::string LwrDriver::nothing_came() const {
  const std::string where = fmt::format("device 'lwr': no FRI measurement within {} s on UDP {}",
                                        options_.connect_timeout_s, text_of(socket_->local()));
  if (counts_.invalid)
    return fmt::format("{} with valid numbers and state ({} from {})", where, name_of(last_fault_),
                       text_of(last_bad_from_));
  if (sequence_.counts().accepted > counts_.invalid)
    return fmt::format("{} of an open interface: call friOpen on the controller", where);
  if (counts_.malformed)
    return fmt::format(
        "{}: {} bytes from {} with wrong {} (FRI 1.0 has {} bytes). Check controller and FRI "
        "version",
        where, last_bad_size_, text_of(last_bad_from_), name_of(last_fault_), fri::kMsrSize);
  if (counts_.foreign)
    return fmt::format(
        "{} from {}, but {} datagrams from other addresses: check the option 'controller'", where,
        options_.controller, counts_.foreign);
  return fmt::format(
      "{}. Check that the KRL program has called friOpen, that friSetup has this machine's address "
      "and port {}, and check cable and firewall",
      where, socket_->local().port);
}

/// Virtual time does not advance meanwhile, so the whole handshake is done here.
void LwrDriver::start_in_virtual_time() {
  const double period_s = 1e-9 * static_cast<double>(period_ns_);
  const double patience_s = options_.session.start_timeout_s + options_.connect_timeout_s;
  for (double waited_s = 0.0; !(session_.force_allowed() && sample_.pose_valid);
       waited_s += period_s) {
    if (waited_s > patience_s || session_.error() != devices::DeviceError::kRecoverable)
      throw devices::DeviceOpenError(fmt::format(
          "device 'lwr': the controller in virtual time did not start: {}", status_text()));
    reply_without_force();
    if (wait_and_take(Clock::now() + seconds(options_.virtual_timeout_s)) != Intake::kNew)
      throw devices::DeviceOpenError(fmt::format(
          "device 'lwr': the controller in virtual time at {} stopped replying during the start",
          text_of(controller_)));
    accept();
  }
  clock_->zero();
  sample_.time_ns = 0;
  fresh_ = true;
}

DeviceDescription describe_lwr(double period_s) {
  DeviceDescription d = sim::sim_lwr().description;
  d.model = "lwr";
  d.rate_hz = 1.0 / period_s;
  d.delay_s = period_s +
              0.001;  // the controller interpolates over one period; then its torque loop (assumed)
  return d;
}

LwrDriver::~LwrDriver() {
  disengage();
  try {
    if (!options_.capture_file.empty())
      capture_.write(options_.capture_file);
  } catch (const std::exception&) {
    // The file could be opened at the start; a disk that has filled up since then must not abort
    // the process.
  }
}

void LwrDriver::disengage() noexcept {
  const bool requested = session_.phase() == fri::FriSession::Phase::kStarting ||
                         session_.phase() == fri::FriSession::Phase::kRunning;
  session_.request_stop();
  stop();
  // A request may be lost.
  const std::uint64_t received_enough = counts_.answered + (requested ? 3 : 0);
  const auto deadline = Clock::now() + seconds(options_.stop_timeout_s);
  while (requested && !(session_.stopped() && counts_.answered >= received_enough)) {
    const Intake intake = wait_and_take(deadline);
    if (intake == Intake::kNothing)
      return;
    if (intake == Intake::kInvalid)
      continue;
    accept();
    reply_without_force();
  }
}

std::string LwrDriver::sentence_for(const Snapshot& snapshot) {
  std::string text(sentence_of(snapshot.diagnostic));
  const unsigned off = ~snapshot.power & fri::kAllDrives;
  if (snapshot.error)
    text += fmt::format(" [errors of {}]", joints_of(snapshot.error));
  if (snapshot.warning)
    text += fmt::format(" [warnings of {}]", joints_of(snapshot.warning));
  if (off)
    text += fmt::format(" [drives off: {}]", joints_of(off));
  return text;
}

std::string LwrDriver::status_text() const { return sentence_for(take_snapshot()); }

std::string LwrDriver::last_error() const {
  if (silent_.load(std::memory_order_relaxed)) {
    const auto silence = Clock::now() - received_.load(std::memory_order_relaxed);
    return fmt::format(
        "no message from the controller on UDP {} for {:.1f} s. Check power, cable and the KRL "
        "program",
        text_of(socket_->local()), std::chrono::duration<double>(silence).count());
  }
  const Snapshot snapshot = snapshot_.load(std::memory_order_relaxed);
  if (snapshot.diagnostic != fri::Diagnostic::kNone)
    return sentence_for(snapshot);
  if (snapshot.usable)
    return {};
  return "no force: the controller's measurement has NaN, infinity or impossible values. Check its "
         "messages and the arm's sensors";
}

}  // namespace voxtouch::lwr

// FRI datagrams in both directions. First byte odd: the rest is one datagram for both decoders; an
// accepted one re-encodes to the same bytes. Even: a controller that follows the handshake sends to
// the driver, and the input patches its datagrams. The decoder accepts every answer; without push
// outside command mode, within the joints' torques and the arm's step limit. This file replaces
// udp_socket.cpp, so that nothing depends on time or ports.
#include <deque>
#include <memory>
#include <vector>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/lwr_driver.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

constexpr voxtouch::arm::UdpEndpoint kController{0x7F000001, 49939};

struct Network {
  std::deque<std::string> to_driver;
  std::vector<std::string> to_controller;
  std::atomic<bool> quiet{false};  // the driver must not wait for missing datagrams
} g_network;

}  // namespace

namespace voxtouch::arm {

std::string text_of(const UdpEndpoint&) { return "here"; }
std::optional<std::uint32_t> parse_ipv4(const std::string&) noexcept { return 0x7F000001; }
UdpSocket::UdpSocket(const std::string&, std::uint16_t) {}
UdpSocket::~UdpSocket() = default;
bool UdpSocket::wait(std::chrono::nanoseconds) noexcept {
  g_network.quiet = g_network.to_driver.empty();
  return !g_network.to_driver.empty();
}
std::optional<UdpSocket::Datagram> UdpSocket::receive(std::span<std::byte> buffer) noexcept {
  if (g_network.to_driver.empty())
    return std::nullopt;
  const std::string bytes = std::move(g_network.to_driver.front());
  g_network.to_driver.pop_front();
  std::memcpy(buffer.data(), bytes.data(), std::min(bytes.size(), buffer.size()));
  return Datagram{bytes.size(), kController, std::chrono::nanoseconds(0)};
}
bool UdpSocket::send(std::span<const std::byte> datagram, const UdpEndpoint&) noexcept {
  g_network.to_controller.emplace_back(reinterpret_cast<const char*>(datagram.data()),
                                       datagram.size());
  return true;
}

}  // namespace voxtouch::arm

namespace {

using namespace voxtouch;

template <class Packet>
void encodes_back(std::string_view bytes) {
  Packet packet{};
  if (lwr::fri::decode(std::as_bytes(std::span(bytes)), packet) != lwr::fri::PacketFault::kNone)
    return;
  FUZZ_REQUIRE(bytes.size() == sizeof packet &&
               std::memcmp(bytes.data(), &packet, sizeof packet) == 0);
  if constexpr (std::is_same_v<Packet, lwr::fri::CmdPacket>)
    FUZZ_REQUIRE(lwr::fri::finite(packet));
}

lwr::LwrOptions usual_options() {
  lwr::LwrOptions options;
  options.silence_s = 60.0;
  options.session.start_timeout_s = 0.05, options.session.pause_s = 0.002;
  options.cancelled = &g_network.quiet;
  return options;
}

class Controller {
 public:
  Controller() {
    msr_.interface.state = lwr::fri::State::kMon;
    msr_.interface.quality = lwr::fri::Quality::kPerfect;
    msr_.interface.msr_period_s = msr_.interface.cmd_period_s = 0.001F;
    msr_.robot.power = lwr::fri::kAllDrives;
    msr_.robot.control = lwr::fri::Control::kJointImpedance;
    msr_.krl.integer[lwr::fri::kToIntEcho] = lwr::fri::kKrlInitialised;
    msr_.data.jnt_pos = msr_.data.cmd_jnt_pos = lwr::fri::to_wire(lwr::lwr_rest_posture());
    msr_.data.cart_pos = lwr::fri::to_wire(lwr::LwrArm().flange(lwr::lwr_rest_posture()));
  }

  /// One byte: number of patches, whether they persist, and whether the datagram is cut; each
  /// patch: offset, length, content.
  void send(fuzz::Bytes& in) {
    const auto choice = in.take<std::uint8_t>();
    ++msr_.header.send_seq;
    msr_.interface.timestamp_s += 0.001F;
    lwr::fri::MsrPacket sent = msr_;
    for (int n = 0; n < (choice & 7); ++n) {
      const std::size_t at = in.take<std::uint16_t>() % sizeof sent;
      const std::string_view bytes =
          in.take(std::min<std::size_t>(in.take<std::uint8_t>() % 33, sizeof sent - at));
      std::memcpy(reinterpret_cast<char*>(&sent) + at, bytes.data(), bytes.size());
    }
    if (choice & 8)
      msr_ = sent;
    std::string bytes(reinterpret_cast<const char*>(&sent), sizeof sent);
    if (choice & 16)
      bytes.resize(in.take<std::uint16_t>() % 2048);
    g_network.to_driver.push_back(std::move(bytes));
  }

  void follow(const lwr::fri::CmdPacket& command) {
    const bool run = command.krl.integer[lwr::fri::kFrmIntRun] == lwr::fri::kRun;
    msr_.interface.state = run ? lwr::fri::State::kCmd : lwr::fri::State::kMon;
    msr_.krl.integer[lwr::fri::kToIntEcho] = run ? lwr::fri::kRun : lwr::fri::kHalt;
    msr_.header.refl_seq = command.header.send_seq;
  }

 private:
  lwr::fri::MsrPacket msr_ = lwr::fri::empty_msr();
};

/// Checks all new answers; the controller follows them.
void receive_at(Controller& controller, const lwr::LwrDriver* driver,
                const lwr::LwrOptions& options) {
  for (const std::string& bytes : std::exchange(g_network.to_controller, {})) {
    lwr::fri::CmdPacket command{};
    FUZZ_REQUIRE(lwr::fri::decode(std::as_bytes(std::span(bytes)), command) ==
                 lwr::fri::PacketFault::kNone);
    const lwr::LwrJoints torque = lwr::fri::from_wire(command.command.add_jnt_trq);
    FUZZ_REQUIRE((torque.array().abs() <= options.max_add_torque_nm.array() * (1.0 + 1e-6)).all());
    const Vec6 wrench =
        Eigen::Map<const Eigen::Matrix<float, 6, 1>>(command.command.add_tcp_ft.data())
            .cast<double>();
    FUZZ_REQUIRE(wrench.head<3>().norm() < 1e3 && wrench.tail<3>().norm() < 1e3);
    const bool pushes = !torque.isZero(0.0) || !wrench.isZero(0.0);
    if (pushes) {
      FUZZ_REQUIRE(driver != nullptr);
      const lwr::fri::MsrPacket& msr = driver->measurement();
      FUZZ_REQUIRE(msr.interface.state == lwr::fri::State::kCmd &&
                   (msr.robot.power & lwr::fri::kAllDrives) == lwr::fri::kAllDrives);
      FUZZ_REQUIRE(msr.robot.error == 0);
    }
    controller.follow(command);
  }
}

void converse(fuzz::Bytes in) {
  g_network.to_driver.clear(), g_network.to_controller.clear();
  const lwr::LwrOptions options = usual_options();
  Controller controller;
  std::unique_ptr<lwr::LwrDriver> driver;
  g_network.quiet = false;
  controller.send(in);
  try {
    driver = std::make_unique<lwr::LwrDriver>(options);
  } catch (const devices::DeviceOpenError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with("device 'lwr'"));
    receive_at(controller, nullptr, options);
    return;
  }
  receive_at(controller, driver.get(), options);
  for (int n = 0; n < 128 && !in.empty(); ++n) {
    controller.send(in);
    const auto sample = driver->read(std::chrono::microseconds(0));
    if (sample) {
      FUZZ_REQUIRE(sample->pose.finite() && std::abs(sample->pose.orientation.norm() - 1.0) < 1e-6);
      FUZZ_REQUIRE(sample->twist.finite());
      (void)driver->write({Vec3(1.0, -2.0, 3.0), Vec3(0.1, 0.0, -0.1)});
    }
    receive_at(controller, driver.get(), options);
  }
  (void)driver->last_error(), (void)driver->status_text();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  const auto choice = in.take<std::uint8_t>();
  if (choice & 1) {
    encodes_back<lwr::fri::MsrPacket>(in.rest());
    encodes_back<lwr::fri::CmdPacket>(in.rest());
  } else {
    converse(in);
  }
  return 0;
}

#include "fake_controller.hpp"

#include <atomic>
#include <exception>
#include <thread>

namespace voxtouch::test {

using namespace std::chrono_literals;

FakeController::FakeController(const std::string& address) : socket_(address, 0) {
  msr.interface.state = lwr::fri::State::kMon;
  msr.interface.quality = lwr::fri::Quality::kPerfect;
  msr.interface.msr_period_s = msr.interface.cmd_period_s = 0.001F;
  msr.robot.power = lwr::fri::kAllDrives;
  msr.robot.control = lwr::fri::Control::kJointImpedance;
  msr.krl.integer[lwr::fri::kToIntEcho] = lwr::fri::kKrlInitialised;
  msr.data.jnt_pos = msr.data.cmd_jnt_pos = lwr::fri::to_wire(lwr::lwr_rest_posture());
  msr.data.cart_pos = lwr::fri::to_wire(lwr::LwrArm().flange(lwr::lwr_rest_posture()));
}

lwr::fri::MsrPacket FakeController::next() {
  ++periods_;
  ++msr.header.send_seq;
  msr.interface.timestamp_s = static_cast<float>(0.001 * static_cast<double>(periods_));
  return msr;
}

void FakeController::send() { send(next()); }
void FakeController::send(const lwr::fri::MsrPacket& packet) {
  send_bytes(std::as_bytes(std::span(&packet, 1)));
}
void FakeController::send_bytes(std::span<const std::byte> bytes) {
  socket_.send(bytes, {0x7F000001, port});
}

std::vector<lwr::fri::CmdPacket> FakeController::receive() {
  std::vector<lwr::fri::CmdPacket> answers;
  std::array<std::byte, 2048> buffer;
  while (const auto datagram = socket_.receive(buffer)) {
    lwr::fri::CmdPacket command;
    if (lwr::fri::decode(std::span(buffer).first(datagram->size), command) !=
        lwr::fri::PacketFault::kNone)
      continue;
    answers.push_back(command);
    received.push_back(command);
    if (program_runs)
      follow(command);
  }
  return answers;
}

void FakeController::follow(const lwr::fri::CmdPacket& command) {
  const bool run = command.krl.integer[lwr::fri::kFrmIntRun] == lwr::fri::kRun;
  msr.interface.state = run ? lwr::fri::State::kCmd : lwr::fri::State::kMon;
  msr.krl.integer[lwr::fri::kToIntEcho] = run ? lwr::fri::kRun : lwr::fri::kHalt;
  msr.header.refl_seq = command.header.send_seq;
}

void FakeController::serve_while(const std::function<void()>& body) {
  std::atomic<bool> done{false};
  std::thread server([&] {
    while (!done) {
      send();
      std::this_thread::sleep_for(500us);
      receive();
    }
  });
  std::exception_ptr thrown;
  try {
    body();
  } catch (...) {
    thrown = std::current_exception();
  }
  done = true;
  server.join();
  if (thrown)
    std::rethrow_exception(thrown);
}

std::unique_ptr<lwr::LwrDriver> FakeController::open(lwr::LwrOptions options) {
  if (options.port == lwr::fri::kDefaultPort)
    options = quick_options();
  port = options.port;
  std::unique_ptr<lwr::LwrDriver> driver;
  serve_while([&] { driver = std::make_unique<lwr::LwrDriver>(options); });
  (void)cycle(*this, *driver);  // takes the packets sent while the driver opened
  return driver;
}

void FakeController::close(std::unique_ptr<lwr::LwrDriver> driver) {
  serve_while([&] { driver.reset(); });
}

lwr::LwrOptions quick_options() {
  lwr::LwrOptions options;
  options.address = "127.0.0.1";
  options.port = arm::UdpSocket("127.0.0.1", 0).local().port;
  options.connect_timeout_s = 5.0;
  options.silence_s = 10.0;  // these two: a test machine may be busy
  options.max_age_s = 5.0;
  options.stop_timeout_s = 0.05;
  options.session.pause_s = 0.01;
  options.session.start_timeout_s = 0.05;
  return options;
}

Cycle cycle(FakeController& controller, lwr::LwrDriver& driver, const Wrench& command) {
  controller.send();
  Cycle result;
  result.sample = driver.read(20ms);
  if (result.sample)
    result.written = driver.write(command);
  const auto answers = controller.receive();
  result.answers = answers.size();
  if (!answers.empty())
    result.command = answers.back();
  return result;
}

bool run_to_command(FakeController& controller, lwr::LwrDriver& driver) {
  for (int n = 0; n < 200; ++n)
    if (const Cycle t = cycle(controller, driver); t.sample && t.written)
      return true;
  return false;
}

double torque_of(const lwr::fri::CmdPacket& command) {
  return lwr::fri::from_wire(command.command.add_jnt_trq).cwiseAbs().maxCoeff();
}

}  // namespace voxtouch::test

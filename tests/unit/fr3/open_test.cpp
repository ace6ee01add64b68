// Opening over the network: detection of the server and its version, and the sentences for others.
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "devices/fr3/fr3_driver.hpp"
#include "devices/fr3/simulated/fci_server.hpp"

namespace voxtouch::fr3 {
namespace open_test {

using namespace std::chrono_literals;

/// A robot in real time on a separate thread.
class Robot {
 public:
  explicit Robot(std::uint16_t version = 10, std::vector<std::string> faults = {},
                 const Vec3& ee_in_flange = Vec3::Zero()) {
    std::vector<fr3_sim::Fault> parsed;
    for (const std::string& text : faults)
      parsed.push_back(parse_fault(text, fr3_sim::kFaults));
    fr3_sim::RobotConfig config;
    config.version = version;
    config.ee_in_flange = ee_in_flange;
    sim::OperatorConfig released;
    released.released = true;
    Motion rest;
    rest.path = {Vec3::Zero()};
    const fr3_sim::FaultSchedule schedule(parsed);
    robot_.emplace(config, hand::Hand(released, rest, fr3_sim::kSubstep), schedule);
    server_.emplace(fr3_sim::ServerConfig{}, *robot_, fr3_sim::Line(schedule, fr3_sim::kTick, 1));
    thread_ = std::thread([this] { server_->run(stop_); });
  }
  ~Robot() {
    stop_ = true;
    thread_.join();
  }
  Fr3Options options() const {
    Fr3Options o;
    o.address = "127.0.0.1";
    o.port = server_->port();
    return o;
  }

 private:
  std::atomic<bool> stop_{false};
  std::optional<fr3_sim::FciRobot> robot_;
  std::optional<fr3_sim::FciServer> server_;
  std::thread thread_;
};

std::string refusal(const Fr3Options& options) {
  try {
    const Fr3Driver driver(options);
  } catch (const devices::DeviceOpenError& error) {
    return error.what();
  }
  return {};
}

TEST(Fr3Open, SpeaksTheVersionThatTheRobotHas) {
  for (const std::uint16_t version :
       std::initializer_list<std::uint16_t>{10, 9, 8, 7, 6, 5, 4, 3}) {
    const Robot robot(version);
    Fr3Driver driver(robot.options());
    EXPECT_EQ(driver.version(), version);
    for (int i = 0; i < 2000 && !driver.session().force_allowed(); ++i)
      (void)driver.read(20ms), (void)driver.write({});
    EXPECT_TRUE(driver.session().force_allowed()) << version << ": " << driver.last_error();
  }
}

/// A TCP server that answers Connect with these bytes and closes.
std::string refusal_after(const std::string& bytes) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(listen(listener, 4), 0);
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  std::thread server([&] {
    const int one = accept(listener, nullptr, nullptr);
    char request[64];
    (void)!recv(one, request, sizeof request, 0);
    (void)!send(one, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    close(one);
  });
  Fr3Options options;
  options.address = "127.0.0.1";
  options.port = ntohs(address.sin_port);
  const std::string said = refusal(options);
  server.join();
  close(listener);
  return said;
}

TEST(Fr3Open, NamesAPortWithoutAnFciServer) {
  for (const std::string& bytes : {std::string("SSH-2.0-OpenSSH_9.2p1 Debian\r\n"),
                                   std::string("HTTP/1.1 400 Bad Request\r\n\r\n"),
                                   std::string("hello"), std::string(200, '\0')})
    EXPECT_TRUE(refusal_after(bytes).contains("is not an FCI server"))
        << bytes << ": " << refusal_after(bytes);
  EXPECT_TRUE(refusal_after("").contains("closed the connection"));
}

TEST(Fr3Open, ReportsAServerOfAnotherVersion) {
  const auto refused_by = [](std::uint16_t version) {
    const fci::Message m = fci::connect_answer(0, false, version);
    return refusal_after({reinterpret_cast<const char*>(m.bytes.data()), m.size});
  };
  EXPECT_TRUE(
      refused_by(11).contains("server 11, this driver 3 to 10; this version is not supported"))
      << refused_by(11);
  EXPECT_TRUE(refused_by(2).contains("update the robot's system image")) << refused_by(2);
}

TEST(Fr3Open, ReportsThatNoServerListensAndWhatToDo) {
  Fr3Options options;
  options.address = "127.0.0.1";
  options.port = 1;
  const std::string said = refusal(options);
  EXPECT_NE(said.find("TCP 127.0.0.1:1"), std::string::npos) << said;
  EXPECT_NE(said.find("activate FCI"), std::string::npos) << said;
  options.address = "the robot";
  EXPECT_NE(refusal(options).find("IPv4"), std::string::npos);
}

TEST(Fr3Open, AcceptsTheRobotsEndEffector) {
  const Robot robot(10, {}, Vec3(0.0, 0.0, 0.1034));
  EXPECT_EQ(refusal(robot.options()), "");
}

TEST(Fr3Open, WaitsForTheOperatorAndReportsIt) {
  const Robot robot(10, {"not_ready@0:60"});
  const Fr3Driver driver(robot.options());
  EXPECT_NE(driver.last_error().find("joints"), std::string::npos) << driver.last_error();
}

TEST(Fr3Open, ActiveReflexIsRefusedWithAMessage) {
  const Robot robot(10, {"reflex@0:60:6"});
  std::this_thread::sleep_for(20ms);
  const std::string said = refusal(robot.options());
  EXPECT_NE(said.find("[joint reflex]"), std::string::npos) << said;
}

TEST(Fr3Open, ClosedChannelIsReportedAsDisconnected) {
  const Robot robot(10, {"closed@1:60"});
  Fr3Driver driver(robot.options());
  devices::DeviceError last = devices::DeviceError::kTimeout;
  for (int i = 0; i < 3000 && last != devices::DeviceError::kDisconnected; ++i) {
    const auto sample = driver.read(20ms);
    if (!sample)
      last = sample.error();
    (void)driver.write({Vec3(3, 0, 0), Vec3::Zero()});
  }
  EXPECT_EQ(last, devices::DeviceError::kDisconnected);
  EXPECT_NE(driver.last_error().find("closed"), std::string::npos) << driver.last_error();
}

}  // namespace open_test
}  // namespace voxtouch::fr3

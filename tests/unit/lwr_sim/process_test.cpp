// The program: start, communication, end.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <sstream>

#include "devices/arm/udp_socket.hpp"
#include "devices/lwr/lwr_arm.hpp"
#include "devices/operator/hand.hpp"
#include "devices/operator/hand_file.hpp"
#include "tests/support/process/process.hpp"
#include "tests/unit/lwr_sim/scripted_remote.hpp"

namespace voxtouch::lwr_sim {
namespace {

using namespace std::chrono_literals;
using voxtouch::test::Process;
using voxtouch::test::TemporaryFolder;

const std::string kProgram = std::string(VOXTOUCH_BIN) + "/voxtouch_fri_controller";

std::string remote_of(const arm::UdpSocket& socket) { return arm::text_of(socket.local()); }

/// Answers until the controller sends OFF or nothing is received for `patience`; returns the last
/// measurement.
lwr_sim::test::MsrBytes serve(arm::UdpSocket& socket, std::chrono::nanoseconds patience,
                              int most = 1 << 30) {
  lwr_sim::test::ScriptedRemote remote;
  lwr_sim::test::MsrBytes msr{};
  std::array<std::byte, 2048> buffer;
  int newest = -1;
  while (most > 0 && socket.wait(patience)) {
    const auto datagram = socket.receive(buffer);
    if (!datagram || datagram->size != 916)
      continue;
    std::memcpy(msr.data(), buffer.data(), msr.size());
    if (lwr_sim::test::state(msr) == 0)
      break;
    if (lwr_sim::test::sequence(msr) <= newest)
      continue;
    newest = lwr_sim::test::sequence(msr);
    socket.send(remote.answer(msr), datagram->from);
    --most;
  }
  return msr;
}

TEST(ControllerProgram, EndsCleanlyBySigtermAndReportsOff) {
  arm::UdpSocket socket("127.0.0.1", 0);
  Process program({kProgram, "--remote", remote_of(socket), "--period-ms", "10"});
  serve(socket, 5s, 20);
  program.signal(SIGTERM);
  EXPECT_EQ(lwr_sim::test::state(serve(socket, 2s)), 0);
  const auto end = program.wait(10s);
  EXPECT_EQ(end.status, 0) << end.err;
  EXPECT_NE(end.err.find("replies"), std::string::npos) << end.err;
}

TEST(ControllerProgram, EndsCleanlyBySigtermInVirtualTime) {
  arm::UdpSocket socket("127.0.0.1", 0);
  Process program({kProgram, "--remote", remote_of(socket), "--virtual-time", "--patience", "60"});
  ASSERT_TRUE(socket.wait(5s));
  program.signal(SIGTERM);
  EXPECT_EQ(program.wait(5s).status, 0);
}

TEST(ControllerProgram, ReportsATakenPortAndAMissingAnswer) {
  arm::UdpSocket socket("127.0.0.1", 0);
  const std::string port = std::to_string(socket.local().port);
  Process second({kProgram, "--port", port});
  auto end = second.wait(10s);
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.err.find(port), std::string::npos) << end.err;
  Process lonely({kProgram, "--remote", remote_of(socket), "--virtual-time", "--patience", "0.2"});
  end = lonely.wait(10s);
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.err.find("no reply"), std::string::npos) << end.err;
}

TEST(ControllerProgram, RefusesInvalidOptions) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--fault", "lat@1"},
        {"--remote", "here"},
        {"--remote", "127.0.0.1:70000"},
        {"--period-ms", "0"},
        {"--hand", "/nonexistent"},
        {"--trace", "/nonexistent/t.csv"},
        {"--torque-feedback-gain", "0"},
        {"--posture-deg", "200", "0", "0", "0", "0", "0", "0"}}) {
    std::vector<std::string> all = {kProgram};
    all.insert(all.end(), options.begin(), options.end());
    Process program(all);
    const auto end = program.wait(10s);
    EXPECT_EQ(end.status, 1) << options[0] << " " << options[1];
    EXPECT_FALSE(end.err.empty());
  }
}

TEST(ControllerProgram, FollowsAHandFileAndTracesAFault) {
  TemporaryFolder folder;
  const Pose rest = lwr::LwrArm().tool(lwr::lwr_rest_posture());
  hand::HandFile file;
  file.motion.path = {rest.position, rest.position + Vec3(0.0, 0.05, 0.0)};
  file.motion.orientation = rest.orientation;
  file.hand = *hand::grip("arm");
  std::ofstream(folder / "hand") << hand::to_text(file);
  arm::UdpSocket socket("127.0.0.1", 0);
  const std::string trace = (folder / "trace.csv").string();
  Process program({kProgram, "--remote", remote_of(socket), "--virtual-time", "--duration", "2.6",
                   "--hand", (folder / "hand").string(), "--trace", trace, "--fault", "estop@2.5"});
  serve(socket, 5s);
  const auto end = program.wait(10s);
  ASSERT_EQ(end.status, 0) << end.err;
  EXPECT_NE(end.err.find("emergency stop"), std::string::npos);
  std::ifstream in(trace);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line.substr(0, 33), "time_s,state,quality,braked,tip_x");
  int rows = 0, braked = 0;
  double y_at_stop = 0.0, y_end = 0.0;
  while (std::getline(in, line)) {
    ++rows;
    std::stringstream cells(line);
    std::vector<std::string> cell;
    for (std::string c; std::getline(cells, c, ',');)
      cell.push_back(c);
    ASSERT_EQ(cell.size(), 22u);
    if (cell[3] == "1") {
      ++braked;
      EXPECT_EQ(cell[1], "mon");
      EXPECT_EQ(cell[10] + cell[11] + cell[12], "000") << line;
      y_end = std::stod(cell[5]);
    } else {
      y_at_stop = std::stod(cell[5]);
    }
  }
  EXPECT_EQ(rows, 2600);
  EXPECT_EQ(braked, 100);
  EXPECT_NEAR(y_at_stop - rest.position.y(), 0.05, 0.01);
  EXPECT_NEAR(y_end, y_at_stop, 1e-3);
}

}  // namespace
}  // namespace voxtouch::lwr_sim

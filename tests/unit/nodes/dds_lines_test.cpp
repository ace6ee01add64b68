// Output of DDS on stderr about datagrams that any participant may send.
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include <dds/ddsrt/log.h>

#include "nodes/bus/participant.hpp"
#include "nodes/console/log.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Lines on stderr after `reported`, and its duration [s].
struct Said {
  std::string text;
  long lines = 0;
  double seconds = 0.0;
};
template <class F>
Said said_while(F&& reported) {
  testing::internal::CaptureStderr();
  const auto begin = Clock::now();
  reported();
  console::flush_log(std::chrono::seconds(5));
  Said said{testing::internal::GetCapturedStderr(), 0,
            std::chrono::duration<double>(Clock::now() - begin).count()};
  said.lines = std::count(said.text.begin(), said.text.end(), '\n');
  return said;
}

/// Four per second, and the count of skipped ones.
long most_lines(const Said& said) { return 5 * static_cast<long>(said.seconds + 2.0); }

TEST(DdsLogLines, AreRateLimitedUnderMalformedDatagrams) {
  const bus::Participant participant({kDomain, "lo", "flooded"});
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * kDomain));
  // A header of RTPS 2.1, then a DATA with a length beyond the datagram.
  std::array<unsigned char, 44> bytes{'R',  'T',  'P', 'S', 2, 1, 1,    16,  1,  2,
                                      3,    4,    5,   6,   7, 8, 9,    10,  11, 12,
                                      0x15, 0x07, 20,  0,   0, 0, 0xff, 0xff};
  const Said said = said_while([&] {
    for (int i = 0; i < 20'000; ++i) {
      (void)!sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                    sizeof to);
      if (i % 100 == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  close(fd);
  EXPECT_GT(said.lines, 3) << "DDS says nothing of these: no flood\n" << said.text;
  EXPECT_LE(said.lines, most_lines(said)) << said.text.substr(0, 2000);
  EXPECT_NE(said.text.find(" more lines"), std::string::npos) << said.text.substr(0, 2000);
}

TEST(DdsLogLines, AreRateLimitedAcrossThreads) {
  const bus::Participant participant({kDomain, "lo", "talkative"});
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // another test's second is over
  const Said said = said_while([] {
    std::vector<std::thread> threads;
    for (int n = 0; n < 4; ++n)
      threads.emplace_back([] {
        for (int i = 0; i < 50'000; ++i)
          dds_log(DDS_LC_WARNING, __FILE__, __LINE__, DDS_FUNCTION, "a line of a flood\n");
      });
    for (std::thread& thread : threads)
      thread.join();
  });
  EXPECT_GE(said.lines, 4) << said.text;
  EXPECT_LE(said.lines, most_lines(said)) << said.text.substr(0, 2000);
}

}  // namespace
}  // namespace voxtouch::test

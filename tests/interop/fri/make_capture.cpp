// Writes a capture of named packets: more than the buffer holds, so that the file includes the
// wrap-around.
#include <cstdio>
#include <exception>

#include "devices/lwr/fri_capture.hpp"
#include "tests/interop/fri/named_packets.hpp"

int main(int count, char** arguments) try {
  if (count != 2)
    return 2;
  using namespace voxtouch;
  lwr::fri::FriCapture capture(7);
  const lwr::fri::MsrPacket msr = lwr::fri::test::named_msr();
  const lwr::fri::CmdPacket cmd = lwr::fri::test::named_cmd();
  const arm::UdpEndpoint controller{0xC0A80014, 49938}, here{0xC0A8000A, 49938};
  for (int i = 0; i < 5; ++i) {
    capture.note(std::as_bytes(std::span(&msr, 1)), controller, here,
                 1'700'000'000'000'000'000 + 1'000'000 * i);
    capture.note(std::as_bytes(std::span(&cmd, 1)), here, controller,
                 1'700'000'000'000'300'000 + 1'000'000 * i);
  }
  capture.write(arguments[1]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

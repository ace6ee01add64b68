/// make_bag FOLDER closed|killed: 500 messages of the size and fields of DeviceState and one latched text,
/// through the recorder as the logger uses it. `killed` ends itself by SIGKILL once everything is committed,
/// with the write-ahead log beside the bag.
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/logger/recording_qos.hpp"

namespace {

using namespace voxtouch;

/// Little-endian CDR of fields that are all 8 bytes wide, as the ring's types begin.
template <class... Field>
std::vector<std::byte> cdr(Field... fields) {
  static_assert(((sizeof(Field) == 8) && ...));
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  const auto add = [&](const void* field) {
    const auto* raw = static_cast<const std::byte*>(field);
    bytes.insert(bytes.end(), raw, raw + 8);
  };
  (add(&fields), ...);
  return bytes;
}

int fail(const std::string& sentence) {
  std::fprintf(stderr, "%s\n", sentence.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return fail("usage: make_bag FOLDER closed|killed");
  auto writer = bag::BagWriter::create(argv[1]);
  if (!writer) return fail(writer.error().sentence);
  bag::BagRecorder recorder(std::make_unique<bag::BagWriter>(std::move(*writer)));
  const auto offered = [](qos::ProfileId id) {
    return logger::offered_qos_text(qos::make_qos(qos::profile(id), qos::Endpoint::kWriter, 0.001).get());
  };
  const auto state = recorder.add_topic(
      {"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", offered(qos::ProfileId::kStream), 0});
  const auto text =
      recorder.add_topic({"/haptic/note", "std_msgs/msg/String", "cdr", offered(qos::ProfileId::kLatched), 0});
  if (!state || !text) return fail("a topic was refused");
  // header (1 byte of padding is said there), length 6, "hello", padding
  const char hello[] = "\0\1\0\1\6\0\0\0hello\0\0";
  recorder.push(*text, 1'700'000'000'000'000'000, std::as_bytes(std::span(hello, 16)));
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double x = 0.001 * static_cast<double>(i);
    const auto time = static_cast<std::int64_t>(1'700'000'000'000'000'000 + 1'000'000 * i);
    // session, sequence, time, position, quaternion, linear, angular; buttons and flags as one field
    const auto bytes = cdr(std::uint64_t{77}, i, static_cast<std::int64_t>(1'000'000 * i), x, -x, 2 * x, 0.0,
                           0.0, 0.0, 1.0, 1.0, 0.0, 0.0,
                           0.0, 0.0, 0.0, std::uint64_t{5} << 32 | 1U);
    recorder.push(*state, time, bytes);
  }
  if (std::string(argv[2]) == "killed") {
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    std::raise(SIGKILL);
  }
  const auto report = recorder.stop();
  return report.errors.empty() ? 0 : fail(report.errors.front());
}

/// make_bag FOLDER closed|killed [sqlite3|mcap] [split]: 500 messages of the size and fields of
/// DeviceState and one latched text, through the recorder as the logger uses it. `killed` ends
/// itself by SIGKILL once everything is committed, with the write-ahead log next to the bag.
/// `split`: a file for each 0.2 s.
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/logger/recording_qos.hpp"
#include "voxtouch_msgs/definitions.hpp"
#include "voxtouch_msgs/messages.hpp"

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
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto storage = bag::storage_named(words.size() > 2 ? words[2] : "sqlite3");
  if (words.size() < 2 || words.size() > 4 || !storage ||
      (words.size() == 4 && words[3] != "split"))
    return fail("usage: make_bag FOLDER closed|killed [sqlite3|mcap] [split]");
  auto writer = bag::BagWriter::create(
      words[0], {.storage = *storage, .split = {.time_ns = words.size() == 4 ? 200'000'000 : 0}});
  if (!writer)
    return fail(writer.error().sentence);
  bag::BagRecorder recorder(std::make_unique<bag::BagWriter>(std::move(*writer)));
  const auto offered = [](qos::ProfileId id) {
    return logger::offered_qos_text(
        qos::make_qos(qos::profile(id), qos::Endpoint::kWriter, 0.001).get());
  };
  const auto topic = [&](const char* name, std::string_view type, std::string_view hash,
                         std::string_view definition, qos::ProfileId id) {
    return recorder.add_topic({name, std::string(type), "cdr", offered(id), 0, std::string(hash),
                               std::string(definition)});
  };
  constexpr msg::AnyType kState = msg::kAnyType<msg::DeviceState>;
  const auto state = topic("/haptic/device/state", kState.ros_name, kState.hash,
                           msg::definition_of(kState.ros_name), qos::ProfileId::kStream);
  const auto text =
      topic("/haptic/note", "std_msgs/msg/String", "", "string data\n", qos::ProfileId::kLatched);
  if (!state || !text)
    return fail("a topic was refused");
  // header (with 1 byte of padding), length 6, "hello", padding
  const char hello[] = "\0\1\0\1\6\0\0\0hello\0\0";
  recorder.push(*text, 1'700'000'000'000'000'000, std::as_bytes(std::span(hello, 16)));
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double x = 0.001 * static_cast<double>(i);
    const auto time = static_cast<std::int64_t>(1'700'000'000'000'000'000 + 1'000'000 * i);
    // session, sequence, time, position, quaternion, linear, angular; buttons and flags as one
    // field
    const auto bytes =
        cdr(std::uint64_t{77}, i, static_cast<std::int64_t>(1'000'000 * i), x, -x, 2 * x, 0.0, 0.0,
            0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, std::uint64_t{5} << 32 | 1U);
    recorder.push(*state, time, bytes);
  }
  if (words[1] == "killed") {
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    std::raise(SIGKILL);
  }
  const auto report = recorder.stop();
  return report.errors.empty() ? 0 : fail(report.errors.front());
}

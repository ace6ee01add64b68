// A bag's folder. First byte odd: the rest is its metadata.yaml. Even: its file, in SQLite or MCAP
// by its first bytes. Messages are counted, hashes are computed twice and compared, and messages of
// the ring are decoded or refused.
#include "tests/fuzz/wire.hpp"
#include "tests/support/bag_hash.hpp"
#include "tests/support/whole_bag.hpp"

namespace {

using namespace voxtouch;

/// As a player hands it on.
void play(const bag::BagMessage& message, std::string_view type) {
  static fuzz::Wire<msg::ForceCommand> commands;
  static fuzz::Wire<msg::DeviceState> states;
  static fuzz::Wire<msg::ContactState> contacts;
  const std::string_view cdr(reinterpret_cast<const char*>(message.bytes.data()),
                             message.bytes.size());
  if (type == msg::Type<msg::ForceCommand>::ros_name)
    commands.through(cdr, [](const msg::ForceCommand&) {});
  if (type == msg::Type<msg::DeviceState>::ros_name)
    states.through(cdr, [](const msg::DeviceState&) {});
  if (type == msg::Type<msg::ContactState>::ros_name)
    contacts.through(cdr, [](const msg::ContactState&) {});
}

void check(const bag::WholeBag& reader) {
  std::uint64_t handed = 0;
  const auto read = reader.for_each([&](const bag::BagMessage& message) {
    FUZZ_REQUIRE(message.topic < reader.topics().size());
    (void)bag::ring_sequence_number(message.bytes);
    play(message, reader.topics()[message.topic].type);
    ++handed;
    return true;
  });
  if (!read) {
    FUZZ_REQUIRE(!read.error().sentence.empty());
    return;
  }
  FUZZ_REQUIRE(handed == reader.message_count());
  for (const bag::TopicInfo& topic : reader.topics()) {
    const auto one = bag::hash_topic(reader, topic.name, bag::ring_sequence_number);
    const auto other = bag::hash_topic(reader, topic.name, bag::ring_sequence_number);
    FUZZ_REQUIRE(one.has_value() == other.has_value());
    if (one)
      FUZZ_REQUIRE(one->hash == other->hash && one->messages == topic.message_count);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Folder folder;
  fuzz::Bytes in(data, size);
  const bool metadata = in.take<std::uint8_t>() & 1;
  const std::filesystem::path file =
      folder.write(metadata ? "metadata.yaml" : "bag_0.db3", in.rest());
  if (metadata) {
    if (const auto read = bag::read_metadata(file); !read)
      FUZZ_REQUIRE(!read.error().sentence.empty());
    (void)bag::WholeBag::open(folder.path());
  } else {
    const auto reader = bag::WholeBag::open(file);
    if (reader)
      check(*reader);
    else
      FUZZ_REQUIRE(!reader.error().sentence.empty());
  }
  std::filesystem::remove(file);
  return 0;
}

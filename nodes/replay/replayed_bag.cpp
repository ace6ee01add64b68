#include "nodes/replay/replayed_bag.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>

#include "nodes/bag/bag_reader.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/bus/message_bytes.hpp"
#include "qos/topics.hpp"

namespace voxtouch::replay {
namespace {

template <class T>
T required(bag::Result<T> result) {
  if (!result)
    throw std::runtime_error(result.error().sentence);
  if constexpr (!std::is_void_v<T>)
    return std::move(*result);
}

/// The recorded bytes' header before the answer's.
template <class T>
std::vector<std::byte> bytes_of(const T& answer, std::span<const std::byte> recorded) {
  std::vector<std::byte> bytes(recorded.begin(), recorded.end());
  std::memcpy(bytes.data() + bus::kCdrHeader, &answer, sizeof answer);
  return bytes;
}

template <class T>
Answers::Key key_in(std::span<const std::byte> bytes) {
  T message{};
  if (!bus::read_stream(bytes, message))
    throw std::runtime_error(
        "a message changed between two reads; check that no program writes to the recording");
  return {message.session_id, message.sequence_number};
}

/// Gives the commands of a sample out in the order in which they were made.
class Answerer {
 public:
  explicit Answerer(const Answers& answers) : answers_(answers) {}

  std::optional<std::vector<std::byte>> contact(std::span<const std::byte> recorded) const {
    const auto made = answers_.contacts.find(key_in<msg::ContactState>(recorded));
    return made == answers_.contacts.end() ? std::nullopt
                                           : std::optional(bytes_of(made->second, recorded));
  }
  std::optional<std::vector<std::byte>> command(std::span<const std::byte> recorded) {
    const Answers::Key key = key_in<msg::ForceCommand>(recorded);
    const auto made = answers_.commands.find(key);
    if (made == answers_.commands.end())
      return std::nullopt;
    std::size_t& next = given_[key];
    const std::size_t this_one = std::min(next, made->second.size() - 1);  // DDS delivered it twice
    ++next;
    return bytes_of(made->second[this_one], recorded);
  }

 private:
  const Answers& answers_;
  std::map<Answers::Key, std::size_t> given_;
};

}  // namespace

void write_replayed(const std::filesystem::path& bag, const std::string& rig,
                    const Answers& answers, const std::filesystem::path& folder) {
  const bag::BagReader reader = required(bag::BagReader::open(bag));
  bag::BagWriter writer = required(bag::BagWriter::create(folder, {.storage = reader.storage()}));
  const std::string contacts = "/" + rig + "/" + std::string(qos::kContactState.path),
                    commands = "/" + rig + "/" + std::string(qos::kForceCommand.path);
  std::vector<bag::TopicId> ids;
  for (const bag::TopicInfo& topic : reader.topics())
    ids.push_back(required(writer.add_topic(topic)));
  Answerer answerer(answers);
  using Times = std::numeric_limits<std::int64_t>;
  required(reader.for_each_between(Times::min(), Times::max(), [&](const bag::BagMessage& m) {
    const std::string& name = reader.topics()[m.topic].name;
    std::optional<std::vector<std::byte>> made;
    if (name == contacts)
      made = answerer.contact(m.bytes);
    if (name == commands)
      made = answerer.command(m.bytes);
    if (made)
      required(writer.append(ids[m.topic], m.time_ns, *made));
    if (name != contacts && name != commands)
      required(writer.append(ids[m.topic], m.time_ns, m.bytes));
    return true;
  }));
  required(writer.close());
}

}  // namespace voxtouch::replay

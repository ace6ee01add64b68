// The logger while others continue to write, and the bus with more peers than any participant
// needs.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/logger/logger_node.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(LoggerNode, StopsWhileTheOthersGoOnWriting) {
  const std::string rig = own_rig();
  auto options = node_options<logger::Options>(rig);
  options.bag = std::filesystem::temp_directory_path() / ("voxtouch_logger_" + rig);
  const bus::Participant participant({kDomain, "lo", "chatter"});
  bus::Writer<msg::DeviceState> states(participant, qos::kDeviceState, rig,
                                       qos::profile(qos::ProfileId::kStream));
  NodeThread chatter([&](const std::atomic<bool>& stop) {
    for (msg::DeviceState state{}; !stop.load();
         ++state.sequence_number, std::this_thread::sleep_for(milliseconds(1)))
      states.write(state);
    return 0;
  });
  {
    NodeThread logger([&](const std::atomic<bool>& stop) { return logger::run(options, stop); });
    ASSERT_TRUE(wait_until([&] { return states.matched_count() == 1; })) << logger.error();
    std::this_thread::sleep_for(milliseconds(300));
    logger.request_stop();
    EXPECT_TRUE(wait_until([&] { return logger.status() >= 0; }, seconds(4)))
        << "it waits for a silence that does not come";
    chatter.end();
    EXPECT_EQ(logger.wait(), 0) << logger.error();
  }
  const auto bag = bag::WholeBag::open(options.bag);
  ASSERT_TRUE(bag) << bag.error().sentence;
  EXPECT_GT(bag->topics()[*bag->find_topic("/" + rig + "/device/state")].message_count, 100U);
  std::filesystem::remove_all(options.bag);
}

TEST(Bus, FindsEachOfManyPeers) {
  const std::string rig = own_rig();
  const bus::Participant participant({kDomain, "lo", "crowd"});
  const auto& stream = qos::profile(qos::ProfileId::kStream);
  bus::Reader<msg::ForceCommand> reader(participant, qos::kForceCommand, rig, stream);
  std::vector<bus::Writer<msg::ForceCommand>> writers;
  for (int i = 0; i < 150; ++i)
    writers.emplace_back(participant, qos::kForceCommand, rig, stream);
  ASSERT_TRUE(wait_until([&] { return reader.matched_count() == 150; }));
  EXPECT_EQ(reader.matched().size(), 150U);
  for (auto& writer : writers) {
    writer.write({});
    msg::ForceCommand command;
    dds_instance_handle_t from = 0;
    ASSERT_TRUE(wait_until([&] { return reader.take(command, &from); }));
    EXPECT_TRUE(bus::writer_is_matched(reader.get(), from))
        << "a command writer that is there would lose its place";
  }
  bus::Reader<msg::ForceCommand> other(participant, qos::kForceCommand, "nobody_" + rig, stream);
  EXPECT_FALSE(bus::writer_is_matched(other.get(), 12345));
}

}  // namespace
}  // namespace voxtouch::test

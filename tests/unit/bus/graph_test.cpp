#include "nodes/bus/graph.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "nodes/bus/participant.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::bus {
namespace {

class RosNames : public testing::TestWithParam<RosGraph> {
 protected:
  Participant node(const std::string& space, const std::string& name) const {
    return Participant({domain, "lo", name, {}, {space, name, GetParam()}, {}});
  }
  static std::string name_of(const Participant& asked, const Participant& other) {
    for (int n = 0; n < 500; ++n) {
      asked.graph()->take_names();
      if (std::string name = asked.graph()->name_of(other.guid()); !name.empty())
        return name;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }
  std::uint32_t domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
};

TEST_P(RosNames, OfAnotherParticipantAreKnownAndStayKnown) {
  const Participant own = node("/haptic", "device");
  Guid gone{};
  {
    const Participant talker = node("/", "talker");
    EXPECT_EQ(name_of(own, talker), "/talker");
    gone = talker.guid();
  }
  const Participant late = node("/lab", "late");
  EXPECT_EQ(name_of(late, own), "/haptic/device");
  EXPECT_EQ(own.graph()->name_of(gone), "/talker");
  EXPECT_EQ(own.graph()->name_of(Guid{}), "");
}

INSTANTIATE_TEST_SUITE_P(BothLayouts, RosNames,
                         testing::Values(RosGraph::kHumble, RosGraph::kIron));

}  // namespace
}  // namespace voxtouch::bus

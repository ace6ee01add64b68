#include "nodes/bus/ros_discovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <list>
#include <memory>
#include <ostream>
#include <thread>

#include "tests/support/process/process.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {
namespace {

/// A ROS 2 node of another program: a participant that reads the graph.
class RosNode {
 public:
  RosNode(std::uint32_t domain, const std::string& hash)
      : participant_(participant(domain)),
        topic_(topic()),
        reader_(reader(hash)) {}

 private:
  using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;
  static Qos qos_with(const std::string& user_data) {
    Qos qos(dds_create_qos(), dds_delete_qos);
    dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
    return qos;
  }
  static Entity participant(std::uint32_t domain) {
    return {dds_create_participant(domain, qos_with("enclave=/;").get(), nullptr), "participant"};
  }
  Entity topic() const {
    const auto* const type =
        msg::Type<msg::rmw_dds_common_humble_ParticipantEntitiesInfo>::descriptor;
    return {dds_create_topic(participant_.get(), type, "ros_discovery_info", nullptr, nullptr),
            "topic"};
  }
  Entity reader(const std::string& hash) const {
    return {dds_create_reader(participant_.get(), topic_.get(), qos_with(hash).get(), nullptr),
            "reader"};
  }

  Entity participant_, topic_, reader_;
};

struct Neighbour {
  const char* name;
  std::vector<std::string> hashes;  ///< user data of the readers of other programs
  std::string to_iron, to_humble;   ///< part of the sentence for a ring of this layout
};

void PrintTo(const Neighbour& one, std::ostream* out) { *out << one.name; }

bool wait_for(const std::function<bool()>& holds) {
  for (int n = 0; n < 1000 && !holds(); ++n)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return holds();
}

constexpr char kHash[] = "typehash=RIHS01_0;";

class RosNeighbour : public testing::TestWithParam<Neighbour> {};

TEST_P(RosNeighbour, IsReportedIfItDoesNotListTheRing) {
  const auto domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  const Participant own({domain, "lo", "up", {}, {"/haptic", "up", RosGraph::kHumble}, {}});
  RosDiscovery found(own);
  found.poll();
  const std::size_t before = found.ros_participants();
  std::list<RosNode> others;
  for (const std::string& hash : GetParam().hashes)
    others.emplace_back(domain, hash);
  const auto are_found = [&] {
    const auto lists = [&](const char* hash) {
      return std::ranges::find(GetParam().hashes, hash) != GetParam().hashes.end();
    };
    found.poll();
    return found.ros_participants() >= before + others.size() &&
           (found.has_humble() || !lists("")) && (found.has_later() || !lists(kHash));
  };
  EXPECT_TRUE(wait_for(are_found));
  for (const auto& [graph, part] : {std::pair{RosGraph::kIron, GetParam().to_iron},
                                    {RosGraph::kHumble, GetParam().to_humble}}) {
    const std::string sentence = found.mismatch(graph);
    EXPECT_EQ(sentence.empty(), part.empty()) << sentence;
    EXPECT_TRUE(sentence.contains(part)) << sentence;
  }
}

INSTANTIATE_TEST_SUITE_P(Releases, RosNeighbour,
                         testing::Values(Neighbour{"none", {}, "", ""},
                                         Neighbour{"humble", {""}, "use --ros humble", ""},
                                         Neighbour{"jazzy", {kHash}, "", "remove --ros humble"},
                                         Neighbour{
                                             "both", {"", kHash}, "one of them", "one of them"}),
                         [](const auto& row) { return std::string(row.param.name); });

/// The nodes of a ring join while `up` polls.
TEST(RosDiscovery, IgnoresNodesOfVoxtouchThatJoin) {
  const auto domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  const Participant own({domain, "lo", "up", {}, {"/haptic", "up", RosGraph::kIron}, {}});
  RosDiscovery found(own);
  found.poll();
  const std::size_t before = found.ros_participants();
  constexpr std::size_t kNodes = 10;
  std::list<Participant> nodes;
  std::jthread joining([&] {
    for (std::size_t n = 0; n < kNodes; ++n)
      nodes.emplace_back(
          ParticipantOptions{domain, "lo", "node", {}, {"/haptic", "node", RosGraph::kHumble}, {}});
  });
  EXPECT_TRUE(wait_for([&] {
    for (int n = 0; n < 100; ++n)
      found.poll();
    return found.ros_participants() >= before + kNodes;
  }));
  EXPECT_EQ(found.mismatch(RosGraph::kIron), "");
}

}  // namespace
}  // namespace voxtouch::bus

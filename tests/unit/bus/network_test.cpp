#include "nodes/bus/network.hpp"

#include <gtest/gtest.h>

#include <arpa/inet.h>

#include <fstream>

#include "nodes/bus/entity.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::bus {
namespace {

std::vector<std::string> names(const std::vector<Card>& cards) {
  std::vector<std::string> all;
  for (const Card& card : cards) all.push_back(card.name);
  return all;
}

TEST(Network, OfThisHostIsLoopbackAndTheFirstThreeCardsThatCanDoMulticast) {
  const std::vector<Card> cards{{"eth0", 1, false, true}, {"lo", 2, true, false}, {"tun0", 3, false, false}, {"wlan0", 4, false, true},
                                {"docker0", 5, false, true}, {"eth1", 6, false, true}};
  EXPECT_EQ(names(cards_of_this_host(cards)), (std::vector<std::string>{"lo", "eth0", "wlan0", "docker0"}));
}

TEST(Network, OfThisHostHasLoopback) {
  const std::vector<Card> cards = cards_of_this_host(network_cards());
  ASSERT_FALSE(cards.empty());
  EXPECT_TRUE(cards.front().is_loopback);
  EXPECT_EQ(to_text(cards.front().address), "127.0.0.1");
}

TEST(Network, IsClosedToOtherHostsAndItsMulticastStays) {
  const Network own = network_of(kThisHost, {}, "");
  EXPECT_TRUE(own.is_closed);
  EXPECT_TRUE(own.configuration.contains("<MulticastTimeToLive>0<"));
  const Network one_card = network_of("eth7", {}, "");
  EXPECT_FALSE(one_card.is_closed);
  EXPECT_TRUE(one_card.configuration.contains(R"(<NetworkInterface name="eth7")"));
  EXPECT_FALSE(one_card.configuration.contains("<MulticastTimeToLive>"));
  for (const Network& network : {own, one_card}) EXPECT_FALSE(network.configuration.contains('@')) << network.configuration;
}

TEST(Network, KeepsTheBuiltInSettingsUnderThoseOfTheEnvironment) {
  const std::string added = "<CycloneDDS><Domain><Tracing><Verbosity>warning</Verbosity></Tracing></Domain></CycloneDDS>";
  const Network network = network_of(kThisHost, {}, added);
  EXPECT_TRUE(network.is_closed);
  EXPECT_TRUE(network.configuration.contains("<LeaseDuration>2 s</LeaseDuration>"));
  EXPECT_TRUE(network.configuration.ends_with("," + added));
}

TEST(Network, LeavesTheCardsToAnEnvironmentThatNamesThem) {
  const std::string cards = R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="eth7"/></Interfaces></General></Domain></CycloneDDS>)";
  const test::TemporaryFolder folder;
  std::ofstream(folder / "cards.xml") << cards;
  for (const std::string& added : {cards, "file://" + (folder / "cards.xml").string(), "<CycloneDDS/>," + (folder / "cards.xml").string()}) {
    const Network network = network_of(kThisHost, {"10.0.0.2"}, added);
    EXPECT_FALSE(network.is_closed) << added;
    EXPECT_FALSE(network.configuration.substr(0, network.configuration.size() - added.size()).contains("<NetworkInterface")) << added;
  }
}

TEST(Network, AsksPeersOverACardAndRefusesThemWhereNoneIsHeard) {
  const Network network = network_of("eth7", {"10.0.0.2", "lab"}, "");
  EXPECT_TRUE(network.configuration.contains(R"(<Peer address="10.0.0.2"/><Peer address="lab"/><Peer address="localhost"/>)"));
  EXPECT_THROW(network_of(kThisHost, {"10.0.0.2"}, ""), Error);
}

}  // namespace
}  // namespace voxtouch::bus

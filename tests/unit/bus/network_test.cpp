#include "nodes/bus/network.hpp"

#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "nodes/bus/entity.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::bus {
namespace {

std::vector<std::string> names(const std::vector<Card>& cards) {
  std::vector<std::string> all;
  for (const Card& card : cards)
    all.push_back(card.name);
  return all;
}

TEST(Network, UsesLoopbackAndThreeMulticastCards) {
  const std::vector<Card> cards{{"eth0", 1, false, true},    {"lo", 2, true, false},
                                {"tun0", 3, false, false},   {"wlan0", 4, false, true},
                                {"docker0", 5, false, true}, {"eth1", 6, false, true}};
  EXPECT_EQ(names(cards_of_this_host(cards)),
            (std::vector<std::string>{"lo", "eth0", "wlan0", "docker0"}));
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
  for (const Network& network : {own, one_card})
    EXPECT_FALSE(network.configuration.contains('@')) << network.configuration;
}

TEST(Network, KeepsTheBuiltInSettingsUnderThoseOfTheEnvironment) {
  const std::string added =
      "<CycloneDDS><Domain><Tracing><Verbosity>warning</Verbosity></Tracing></Domain></CycloneDDS>";
  const Network network = network_of(kThisHost, {}, added);
  EXPECT_TRUE(network.is_closed);
  EXPECT_TRUE(network.configuration.contains("<LeaseDuration>2 s</LeaseDuration>"));
  EXPECT_TRUE(network.configuration.ends_with("," + added));
}

TEST(Network, LeavesTheCardsToAnEnvironmentThatNamesThem) {
  const std::string cards =
      R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="eth7"/></Interfaces></General></Domain></CycloneDDS>)";
  const test::TemporaryFolder folder;
  std::ofstream(folder / "cards.xml") << cards;
  for (const std::string& added : {cards, "file://" + (folder / "cards.xml").string(),
                                   "<CycloneDDS/>," + (folder / "cards.xml").string()}) {
    const Network network = network_of(kThisHost, {"10.0.0.2"}, added);
    EXPECT_FALSE(network.is_closed) << added;
    EXPECT_FALSE(network.configuration.substr(0, network.configuration.size() - added.size())
                     .contains("<NetworkInterface"))
        << added;
  }
}

TEST(Network, RefusesSharedMemoryInTheEnvironment) {
  const auto with = [](const std::string& enable) {
    return "<CycloneDDS><Domain><SharedMemory><Enable>" + enable +
           "</Enable><LogLevel>info</LogLevel></SharedMemory></Domain></CycloneDDS>";
  };
  const test::TemporaryFolder folder;
  std::ofstream(folder / "shared.xml") << with("true");
  EXPECT_THROW(network_of(kThisHost, {}, with("true")), Error);
  EXPECT_THROW(network_of(kThisHost, {}, with(" true ")), Error);
  EXPECT_THROW(network_of(kThisHost, {}, "file://" + (folder / "shared.xml").string()), Error);
  EXPECT_NO_THROW(network_of(kThisHost, {}, with("false")));
}

TEST(Network, RefusesATruncatedEnvironment) {
  const std::string whole =
      R"(<CycloneDDS><!-- > --><Domain id='any'><Tracing><Category>a,b</Category></Tracing>)"
      R"(<Internal/></Domain></CycloneDDS>)";
  const test::TemporaryFolder folder;
  const std::string file = (folder / "cut.xml").string();
  for (std::size_t length = 1; length < whole.size(); ++length) {
    const std::string cut = whole.substr(0, length);
    std::ofstream(file) << cut;
    for (const std::string& added : {cut, "<CycloneDDS/>," + cut, "file://" + file})
      EXPECT_THROW(network_of(kThisHost, {}, added), Error) << added << " of " << cut;
  }
  std::ofstream(file) << "<?xml version=\"1.0\"?>\n" << whole << "\n<!-- < -->\n";
  for (const std::string& added :
       {whole, whole + whole, "<?xml version='1.0'?>" + whole + ",", "file://" + file,
        file + "," + whole, std::string("<CycloneDDS a='>\"'><![CDATA[<]]></CycloneDDS>")})
    EXPECT_NO_THROW(network_of(kThisHost, {}, added)) << added;
}

TEST(Network, RefusesFilesOfTheEnvironmentThatConfigureNothing) {
  const test::TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  const std::string none = path("none.xml");
  std::ofstream(path("empty.xml")).flush();
  std::ofstream(path("space.xml")) << " \n";
  std::ofstream(path("other.xml")) << "<profiles/>";
  std::ofstream(path("text.xml")) << "CycloneDDS";
  std::ofstream(path("good.xml")) << "<CycloneDDS/>";
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  for (const auto& [file, why] : {std::pair{none, "does not exist"},
                                  {path("empty.xml"), "is empty"},
                                  {path("space.xml"), "has no element"},
                                  {path("other.xml"), "has no element"},
                                  {path("text.xml"), "has no element"},
                                  {path("pipe"), "is not a regular file"},
                                  {folder.path().string(), "is a folder"}})
    for (const std::string& added :
         {file, "file://" + file, "<CycloneDDS/>," + file, path("good.xml") + "," + file})
      try {
        network_of(kThisHost, {}, added);
        ADD_FAILURE() << added;
      } catch (const Error& error) {
        EXPECT_TRUE(std::string(error.what()).contains(file + ", which " + why)) << error.what();
      }
  // A comma within an element separates nothing.
  const std::string listed =
      "<CycloneDDS><Domain><Tracing><Category>a,b</Category></Tracing></Domain></CycloneDDS>";
  EXPECT_NO_THROW(
      network_of(kThisHost, {}, " " + listed + ",\n," + path("good.xml") + "," + listed));
}

TEST(Network, PollsPeersOverACardAndRefusesThemWithout) {
  const Network network = network_of("eth7", {"10.0.0.2", "lab"}, "");
  EXPECT_TRUE(network.configuration.contains(
      R"(<Peer address="10.0.0.2"/><Peer address="lab"/><Peer address="localhost"/>)"));
  EXPECT_THROW(network_of(kThisHost, {"10.0.0.2"}, ""), Error);
}

/// A UDP socket on this port, as a participant of another process has one.
class Port {
 public:
  explicit Port(std::uint16_t port, int family = AF_INET) : fd_(::socket(family, SOCK_DGRAM, 0)) {
    sockaddr_in ipv4{};
    ipv4.sin_family = AF_INET, ipv4.sin_port = htons(port);
    sockaddr_in6 ipv6{};
    ipv6.sin6_family = AF_INET6, ipv6.sin6_port = htons(port);
    bound_ =
        (family == AF_INET ? ::bind(fd_, reinterpret_cast<sockaddr*>(&ipv4), sizeof ipv4)
                           : ::bind(fd_, reinterpret_cast<sockaddr*>(&ipv6), sizeof ipv6)) == 0;
  }
  ~Port() { ::close(fd_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  int fd() const noexcept { return fd_; }
  bool bound() const noexcept { return bound_; }

 private:
  int fd_;
  bool bound_ = false;
};

TEST(SoleInDomain, UntilAnotherProcessHasAPort) {
  const auto domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  const auto first = static_cast<std::uint16_t>(7400 + 250 * domain);
  const auto alone = [&](const std::vector<int>& own) {
    return is_alone_in_domain(domain, kThisHost, {}, "", own);
  };
  ASSERT_TRUE(alone({}));
  for (const int offset : {0, 1, 10, 249}) {
    const Port other(static_cast<std::uint16_t>(first + offset));
    ASSERT_TRUE(other.bound()) << offset;
    EXPECT_FALSE(alone({})) << offset;
    EXPECT_TRUE(alone({other.fd()})) << offset;  // it belongs to this process
  }
  for (const int offset : {-1, 250}) {
    const Port of_another_domain(static_cast<std::uint16_t>(first + offset));
    EXPECT_TRUE(alone({})) << offset;
  }
  const Port of_both(first, AF_INET6);
  EXPECT_EQ(alone({}), !of_both.bound());  // IPv6 may be switched off
}

TEST(SoleInDomain, IsUnknownOnNetworksBeyondThisHost) {
  const auto domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  EXPECT_TRUE(is_alone_in_domain(domain, "lo", {}, "", {}));
  EXPECT_FALSE(is_alone_in_domain(domain, "eth7", {}, "", {}));
  EXPECT_FALSE(is_alone_in_domain(domain, "lo", {"10.0.0.2"}, "", {}));
  EXPECT_FALSE(is_alone_in_domain(domain, kThisHost, {}, "<CycloneDDS/>", {}));
}

}  // namespace
}  // namespace voxtouch::bus

#include "nodes/bus/exchange.hpp"

#include <gtest/gtest.h>

namespace voxtouch::bus {
namespace {

TEST(ReceptionFault, NamesMulticastDisabledByTheEnvironment) {
  const std::string off =
      "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General></Domain></"
      "CycloneDDS>";
  EXPECT_TRUE(reception_fault(kThisHost, 0, off).contains("AllowMulticast"));
  EXPECT_FALSE(reception_fault(kThisHost, 0, "<CycloneDDS/>").contains("AllowMulticast"));
}

TEST(ReceptionFault, NamesADisabledCard) {
  EXPECT_TRUE(
      reception_fault("no_such_if0", 0, "").contains("no network card of 'no_such_if0' is up"));
}

TEST(ReceptionFault, NamesTheDomainsPortsOnAHealthyMachine) {
  EXPECT_TRUE(reception_fault("lo", 2, "").contains("7900 to 8149"))
      << reception_fault("lo", 2, "");
}

TEST(ReceptionFault, NamesAMissingAddress) {
  const std::vector<Card> cards = network_cards();
  note_addresses(cards);
  EXPECT_EQ(lost_address(), "");
  note_addresses({cards.front(), {"eth7", 0x0907000AU, false, true}});  // 10.0.7.9
  EXPECT_EQ(lost_address(), "address 10.0.7.9 of eth7 was removed from this machine");
  EXPECT_TRUE(reception_fault(kThisHost, 0, "").contains("restart the ring"));
  note_addresses({});
}

}  // namespace
}  // namespace voxtouch::bus

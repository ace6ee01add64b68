#include "nodes/cli/doctor/doctor_checks.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "nodes/bus/exchange.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::cli {
namespace {

long number_in(const char* file) {
  long number = 0;
  return std::ifstream(file) >> number ? number : -1;
}

}  // namespace

std::vector<Finding> check_cards(std::string_view interface_name,
                                 const std::vector<bus::Card>& cards) {
  const bool is_host = interface_name == bus::kThisHost;
  const std::vector<bus::Card> chosen = bus::cards_of_this_host(cards);
  std::vector<Finding> findings;
  for (const bus::Card& card : cards) {
    const std::string name = fmt::format("{} ({})", card.name, bus::to_text(card.address));
    const bool used = is_host ? std::ranges::any_of(
                                    chosen, [&](const bus::Card& c) { return c.name == card.name; })
                              : card.name == interface_name;
    if (!is_host && !used)
      continue;
    if (!used)
      findings.push_back(
          {Health::kWarning,
           fmt::format("Card {} is not used ({}): ROS 2 tools bound to that card only do not "
                       "discover the ring",
                       name, card.is_multicast ? "DDS uses at most four cards" : "no multicast")});
    else if (!bus::multicast_returns(card))
      findings.push_back(
          {is_host ? Health::kBad : Health::kWarning,
           fmt::format("Card {}: multicast does not return to this machine. Check that the "
                       "firewall passes UDP to 239.255.0.1{}",
                       name, is_host ? "" : ", or list the other hosts with --discovery-peer")});
    else
      findings.push_back(
          {Health::kGood, fmt::format("card {} is up, multicast works on this machine", name)});
  }
  if (findings.empty())
    findings.push_back(
        {Health::kBad,
         fmt::format(
             "No network card '{}' is up with an IPv4 address. `ip -4 address` lists the cards",
             interface_name)});
  return findings;
}

std::set<unsigned> taken_indices(std::istream& udp, std::uint32_t domain) {
  constexpr unsigned kLast = 119;
  const unsigned first =
      7400 + 250 * domain + 10;  // index n has first + 2n for discovery, and the next for data
  std::set<unsigned> taken;
  std::string line;
  while (std::getline(udp, line)) {
    const std::size_t colon = line.find(':', line.find(':') + 1);  // "  12: 00000000:1CF2 ..."
    if (colon == std::string::npos || line.size() < colon + 5)
      continue;
    unsigned port = 0;
    std::from_chars(line.data() + colon + 1, line.data() + colon + 5, port, 16);
    if (port >= first && (port - first) / 2 <= kLast)
      taken.insert((port - first) / 2);
  }
  return taken;
}

Finding check_indices(const std::set<unsigned>& taken) {
  constexpr unsigned kOfARing = 7;
  const auto left = [&](unsigned last) {
    return last + 1 - static_cast<unsigned>(std::ranges::count_if(taken, [&](unsigned n) {
             return n <= last;
           }));
  };
  const std::string counts = fmt::format(
      "{} participant indices of the domain are in use; {} are free up to 9, {} up to 32",
      taken.size(), left(9), left(32));
  if (left(119) < kOfARing)
    return {Health::kBad, counts + ": too few for a ring; choose another --domain"};
  if (left(32) < kOfARing)
    return {Health::kWarning,
            counts + ": tools without multicast do not discover a new ring (qos/README.md)"};
  if (left(9) < kOfARing)
    return {Health::kWarning,
            counts +
                ": ROS 2 Humble with ROS_LOCALHOST_ONLY=1 discovers a new ring only "
                "partly (qos/README.md)"};
  return {Health::kGood, counts};
}

std::vector<Finding> check_rights() {
  std::vector<Finding> findings;
  std::thread([&] {  // of this thread only
    for (const std::string& refused : runtime::enter_realtime({}))
      findings.push_back({Health::kWarning, refused});
  })
      .join();
  if (findings.empty())
    findings.push_back({Health::kGood, "real-time scheduling and locked memory are allowed"});
  constexpr long kRequestedBytes = 4L << 20;
  const long allowed = number_in("/proc/sys/net/core/rmem_max");
  if (allowed >= 0 && allowed < kRequestedBytes)
    findings.push_back(
        {Health::kWarning, fmt::format("UDP receive buffers are limited to {} bytes: late readers "
                                       "lose messages. Run `sysctl -w net.core.rmem_max={}`",
                                       allowed, kRequestedBytes)});
  return findings;
}

std::string ros_environment(std::uint32_t domain, std::string_view interface_name) {
  const std::string_view card = interface_name == bus::kThisHost ? "lo" : interface_name;
  return fmt::format(
      "export ROS_DOMAIN_ID={}\n"
      "export CYCLONEDDS_URI='<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
      "name=\"{}\" multicast=\"true\"/></Interfaces></General>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>119</"
      "MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>'\n",
      domain, card);
}

}  // namespace voxtouch::cli

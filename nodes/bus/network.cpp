#include "nodes/bus/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "nodes/bus/entity.hpp"
#include "qos_network.hpp"

namespace voxtouch::bus {
namespace {

using Addresses = std::unique_ptr<ifaddrs, decltype(&freeifaddrs)>;

Addresses all_addresses() {
  ifaddrs* list = nullptr;
  return {getifaddrs(&list) == 0 ? list : nullptr, freeifaddrs};
}

std::uint32_t ipv4_of(const ifaddrs& entry) {
  if (!entry.ifa_addr || entry.ifa_addr->sa_family != AF_INET)
    return 0;
  sockaddr_in address{};
  std::memcpy(&address, entry.ifa_addr, sizeof address);
  return address.sin_addr.s_addr;
}

void fill(std::string& text, std::string_view slot, std::string_view value) {
  text.replace(text.find(slot), slot.size(), value);
}

/// Declares multicast as working: Linux does not report it for loopback, although it works.
std::string card_xml(std::string_view key, std::string_view value) {
  return fmt::format(R"(<NetworkInterface {}="{}" multicast="true"/>)", key, value);
}

std::string cards_xml(std::string_view interface_name) {
  if (interface_name != kThisHost)
    return fmt::format("<Interfaces>{}</Interfaces>", card_xml("name", interface_name));
  std::string xml;
  for (const Card& card : cards_of_this_host(network_cards()))
    xml += card_xml("address", to_text(card.address));
  return fmt::format("<Interfaces>{}</Interfaces><MulticastTimeToLive>0</MulticastTimeToLive>",
                     xml);
}

}  // namespace

std::string to_text(std::uint32_t address) {
  char text[INET_ADDRSTRLEN];
  return inet_ntop(AF_INET, &address, text, sizeof text);
}

std::vector<Card> network_cards() {
  std::vector<Card> cards;
  const Addresses list = all_addresses();
  for (const ifaddrs* entry = list.get(); entry; entry = entry->ifa_next) {
    const std::uint32_t address = ipv4_of(*entry);
    const bool is_known =
        std::ranges::any_of(cards, [&](const Card& card) { return card.name == entry->ifa_name; });
    if (address == 0 || is_known || (entry->ifa_flags & IFF_UP) == 0)
      continue;
    cards.push_back({entry->ifa_name, address, (entry->ifa_flags & IFF_LOOPBACK) != 0,
                     (entry->ifa_flags & IFF_MULTICAST) != 0});
  }
  return cards;
}

std::vector<std::uint32_t> own_addresses() {
  std::vector<std::uint32_t> all;
  const Addresses list = all_addresses();
  for (const ifaddrs* entry = list.get(); entry; entry = entry->ifa_next)
    if (const std::uint32_t address = ipv4_of(*entry);
        address != 0 && (entry->ifa_flags & IFF_UP) != 0)
      all.push_back(address);
  return all;
}

std::vector<Card> cards_of_this_host(const std::vector<Card>& cards) {
  constexpr std::size_t kMaxCards = 4;  // MAX_XMIT_CONNS of Cyclone DDS
  std::vector<Card> chosen;
  std::ranges::copy_if(cards, std::back_inserter(chosen),
                       [](const Card& card) { return card.is_loopback; });
  for (const Card& card : cards)
    if (!card.is_loopback && card.is_multicast && chosen.size() < kMaxCards)
      chosen.push_back(card);
  return chosen;
}

namespace {

/// Position behind the tag, comment or section that begins at `at`; npos if the text ends within
/// it.
std::size_t tag_end(std::string_view xml, std::size_t at) {
  constexpr std::pair<std::string_view, std::string_view> kSections[] = {
      {"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}};
  for (const auto& [begin, end] : kSections)
    if (xml.substr(at).starts_with(begin)) {
      at = xml.find(end, at + begin.size());
      return at == std::string_view::npos ? at : at + end.size();
    }
  for (char quote = '\0'; at < xml.size(); ++at) {
    const char c = xml[at];
    if (quote != '\0' ? c == quote : c == '"' || c == '\'')
      quote = quote == '\0' ? c : '\0';
    else if (quote == '\0' && c == '>')
      return at + 1;
  }
  return std::string_view::npos;
}

/// Position behind the element, comment or section that begins at `at`; npos if the text ends
/// within it.
std::size_t element_end(std::string_view xml, std::size_t at) {
  int depth = 0;
  do {
    const std::size_t end = tag_end(xml, at);
    if (end == std::string_view::npos)
      return end;
    const std::string_view tag = xml.substr(at, end - at);
    if (tag.starts_with("</"))
      --depth;
    else if (!tag.starts_with("<!") && !tag.starts_with("<?") && !tag.ends_with("/>"))
      ++depth;
    at = depth > 0 ? xml.find('<', end) : end;
  } while (depth > 0 && at != std::string_view::npos);
  return at;
}

/// Whether this XML ends within an element, a tag or a comment. Cyclone DDS 0.10.2 accepts most of
/// such texts silently and ignores what is missing. It reports all other syntax errors.
bool is_cut(std::string_view xml) {
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at))
    if (at = element_end(xml, at); at == std::string_view::npos)
      return true;
  return false;
}

/// The files in a list of XML texts and files, separated by commas.
std::vector<std::string> named_files(std::string_view configuration) {
  constexpr std::string_view kFile = "file://";
  std::vector<std::string> files;
  constexpr std::string_view kBetween = " \t\r\n,";
  for (std::size_t at = 0, end = 0;
       (at = configuration.find_first_not_of(kBetween, end)) != std::string_view::npos;) {
    if (configuration[at] == '<') {
      end = element_end(configuration, at);
      continue;
    }
    end = std::min(configuration.find(',', at), configuration.size());
    std::string_view part = configuration.substr(at, end - at);
    if (part.starts_with(kFile))
      part.remove_prefix(kFile.size());
    files.emplace_back(part);
  }
  return files;
}

std::string content_of(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))  // a pipe would block
    return {};
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Whether `holds` is true for the XML in this text or for a file that it names.
template <class Holds>
bool any_part(std::string_view configuration, Holds holds) {
  return holds(configuration) ||
         std::ranges::any_of(named_files(configuration),
                             [&](const std::string& file) { return holds(content_of(file)); });
}

/// Why this file configures nothing; empty if it has an element <CycloneDDS>. Cyclone DDS 0.10.2
/// ignores a folder and an empty file, and waits for the writer of a pipe.
std::string file_fault(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status))
    return "does not exist";
  if (!std::filesystem::is_regular_file(status))
    return std::filesystem::is_directory(status) ? "is a folder" : "is not a regular file";
  if (!std::ifstream(file))
    return "cannot be read";
  const std::string xml = content_of(file);
  if (xml.empty())
    return "is empty";
  return xml.contains("<CycloneDDS") ? "" : "has no element <CycloneDDS>";
}

/// Whether an element SharedMemory of this XML is enabled.
bool enables_shared_memory(std::string_view xml) {
  for (std::size_t at = xml.find("<SharedMemory"); at != std::string_view::npos;
       at = xml.find("<SharedMemory", at + 1)) {
    const std::string_view element = xml.substr(at, xml.find("</SharedMemory", at) - at);
    const std::size_t value = element.find("<Enable>");
    if (value != std::string_view::npos &&
        element.find("true", value) < element.find("</Enable>", value))
      return true;
  }
  return false;
}

}  // namespace

bool names_cards(std::string_view configuration) {
  return any_part(configuration,
                  [](std::string_view xml) { return xml.contains("<NetworkInterface"); });
}

Network network_of(std::string_view interface_name, const std::vector<std::string>& peers,
                   std::string_view added) {
  const bool own_cards = !names_cards(added), is_closed = own_cards && interface_name == kThisHost;
  if (is_closed && !peers.empty())
    throw Error(
        fmt::format("--discovery-peer {} is another host, unreachable from --interface {}. Choose "
                    "the network card of that network",
                    peers.front(), kThisHost));
  for (const std::string& file : named_files(added))
    if (const std::string fault = file_fault(file); !fault.empty())
      throw Error(fmt::format(
          "CYCLONEDDS_URI names {}, which {}. Name a file with an element <CycloneDDS>, "
          "or unset CYCLONEDDS_URI",
          file, fault));
  if (any_part(added, is_cut))
    throw Error(
        "CYCLONEDDS_URI is incomplete: its XML, or that of a file that it names, ends within an "
        "element. Correct CYCLONEDDS_URI, or unset it");
  if (any_part(added, enables_shared_memory))
    throw Error(
        "CYCLONEDDS_URI enables SharedMemory, which voxtouch does not support. Set its Enable to "
        "false");
  std::string xml(qos::kNetworkXml), peers_xml;
  for (const std::string& peer : peers)
    peers_xml += fmt::format(R"(<Peer address="{}"/>)", peer);
  // Discovery contacts each peer at every participant index up to the last. Without peers a high
  // index costs nothing; a domain has 119 ports.
  fill(xml, "@CARDS@", own_cards ? cards_xml(interface_name) : "");
  fill(xml, "@LAST_INDEX@", peers.empty() ? "119" : "32");
  fill(xml, "@PEERS@",
       peers.empty() ? ""
                     : fmt::format(R"(<Peers>{}<Peer address="localhost"/></Peers>)", peers_xml));
  return {added.empty() ? xml : fmt::format("{},{}", xml, added), is_closed};
}

std::vector<int> udp_sockets() {
  std::vector<int> sockets;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int fd = std::stoi(entry.path().filename().string());
    int family = 0, kind = 0;
    socklen_t size = sizeof family;
    if (getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &family, &size) == 0 &&
        getsockopt(fd, SOL_SOCKET, SO_TYPE, &kind, &size) == 0 && family == AF_INET &&
        kind == SOCK_DGRAM)
      sockets.push_back(fd);
  }
  return sockets;
}

namespace {

/// Whether the kernel's list of UDP sockets (proc(5), net/udp) contains a socket with one of these
/// ports that is not one of these inodes.
bool has_port(std::istream& list, std::uint32_t first, std::uint32_t last,
              const std::vector<ino_t>& own) {
  std::string line;
  std::getline(list, line);  // skip the header line
  while (std::getline(list, line)) {
    unsigned port = 0;
    unsigned long long inode = 0;
    if (std::sscanf(line.c_str(), " %*u: %*[0-9A-F]:%x %*s %*s %*s %*s %*s %*u %*u %llu", &port,
                    &inode) != 2)
      return true;  // the list is not available
    if (port >= first && port <= last && std::ranges::find(own, inode) == own.end())
      return true;
  }
  return false;
}

}  // namespace

bool is_alone_in_domain(std::uint32_t domain, std::string_view interface_name,
                        const std::vector<std::string>& peers, std::string_view added,
                        const std::vector<int>& own) {
  constexpr std::uint32_t kBase = 7400, kOfADomain = 250;  // DDSI-RTPS 2.5, 9.6.2.3
  const auto is_loopback = [&](const Card& card) {
    return card.is_loopback && card.name == interface_name;
  };
  if (!added.empty() || !peers.empty() ||
      (interface_name != kThisHost && std::ranges::none_of(network_cards(), is_loopback)))
    return false;
  std::vector<ino_t> inodes;
  for (const int socket : own)
    if (struct stat status{}; fstat(socket, &status) == 0)
      inodes.push_back(status.st_ino);
  const std::uint32_t first = kBase + kOfADomain * domain;
  std::ifstream ipv4("/proc/self/net/udp"),
      ipv6("/proc/self/net/udp6");  // IPv6 sockets receive datagrams of both; IPv6 may be disabled
  return ipv4 && !has_port(ipv4, first, first + kOfADomain - 1, inodes) &&
         (!ipv6 || !has_port(ipv6, first, first + kOfADomain - 1, inodes));
}

void close_to_other_hosts(const std::vector<int>& sockets) {
  std::vector<std::uint32_t> own;  // in the byte order of this machine, as the kernel's filter
                                   // compares
  const Addresses list = all_addresses();
  for (const ifaddrs* entry = list.get(); entry; entry = entry->ifa_next)
    if (const std::uint32_t address = ntohl(ipv4_of(*entry));
        address != 0 && address >> 24U != 127U)
      own.push_back(address);
  constexpr std::size_t kMaxAddresses = 200;  // a jump of the filter spans at most 255 instructions
  own.resize(std::min(own.size(), kMaxAddresses));

  // Of the IPv4 header.
  constexpr std::uint32_t kSource = static_cast<std::uint32_t>(SKF_NET_OFF) + 12;
  const auto to_accept = [&](std::size_t compared) {
    return static_cast<std::uint8_t>(own.size() - compared + 1);
  };
  std::vector<sock_filter> program{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kSource),
                                   BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xff000000U),
                                   BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x7f000000U,
                                            static_cast<std::uint8_t>(own.size() + 2), 0),
                                   BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kSource)};
  for (std::size_t n = 0; n < own.size(); ++n)
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, own[n], to_accept(n + 1), 0));
  program.push_back(BPF_STMT(BPF_RET | BPF_K, 0));
  program.push_back(BPF_STMT(BPF_RET | BPF_K, 0xffffffffU));
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  for (const int socket : sockets)
    if (setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0)
      throw Error(fmt::format("Cannot restrict DDS to this machine ({}). Use --interface lo",
                              std::strerror(errno)));
}

}  // namespace voxtouch::bus

#include "nodes/bus/participant.hpp"

#include <fcntl.h>
#include <limits.h>
#include <net/if.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

#include "nodes/bus/exchange.hpp"
#include "nodes/bus/network.hpp"
#include "nodes/console/log.hpp"
#include "nodes/console/rate_limiter.hpp"
#include "qos/profiles.hpp"

namespace voxtouch::bus {
namespace {

/// Collects the messages of DDS during the start of a domain or participant, because its return
/// code alone does not give the cause.
class StartLines {
 public:
  void clear() {
    const std::lock_guard lock(mutex_);
    lines_.clear();
  }
  void add(std::string_view line) {
    constexpr std::size_t kMaxLines = 3, kMaxBytes = 300;
    const std::lock_guard lock(mutex_);
    while (line.ends_with('\n') || line.ends_with('.'))
      line.remove_suffix(1);
    if (!line.empty() && lines_.size() < kMaxLines)
      lines_.emplace_back(line.substr(0, kMaxBytes));
  }
  /// The collected messages, joined; without messages, the text of the DDS return code.
  std::string text(dds_return_t code) const {
    const std::lock_guard lock(mutex_);
    std::string all;
    for (const std::string& line : lines_)
      all += (all.empty() ? "" : "; ") + line;
    return all.empty() ? std::string(dds_strretcode(-code)) : all;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

StartLines& start_lines() {
  static StartLines lines;
  return lines;
}

/// Prints messages of DDS with time and thread, without blocking: the default output to stderr
/// would stall the receiving thread. DDS prints a message for each malformed datagram, so the rate
/// is limited; otherwise a sender could fill a disk. The configuration enables no tracing, which
/// DDS writes by itself.
void log_from_dds(void*, const dds_log_data_t* data) {
  if ((data->priority & (DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING | DDS_LC_CONFIG)) != 0)
    start_lines().add({data->message, data->size});
  static console::RateLimiter few(4);
  const auto [is_printed, skipped] =
      few.take(std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
  if (skipped > 0)
    console::log("({} more lines of DDS skipped)\n", skipped);
  if (!is_printed && (data->priority & DDS_LC_FATAL) == 0)
    return;
  console::log("{}\n", std::string_view(data->message - data->hdrsize, data->hdrsize + data->size));
}

/// DDS opens sockets, wait sets and files during start-up and aborts without descriptors. It uses
/// select, which accepts no descriptor beyond FD_SETSIZE. The soft limit is only a default, so it
/// is raised.
void require_descriptors() {
  constexpr std::size_t kNeeded = 64;
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < FD_SETSIZE) {
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, FD_SETSIZE);
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  std::vector<int> taken;
  int fd = 0;
  while (taken.size() < kNeeded && fd >= 0 && fd < FD_SETSIZE)
    if (fd = open("/dev/null", O_RDONLY | O_CLOEXEC); fd >= 0)
      taken.push_back(fd);
  for (const int one : taken)
    close(one);
  if (taken.size() < kNeeded || fd >= FD_SETSIZE)
    throw Error("This process can open " + std::to_string(taken.size()) +
                " more files and sockets, DDS needs " + std::to_string(kNeeded) +
                ". Raise the limit (`ulimit -n`, at most " + std::to_string(limit.rlim_max) +
                ") or close files before the start");
}

/// DDS aborts the process if the system refuses it a thread.
void require_threads() {
  constexpr std::size_t kNeeded = 12;  // DDS starts up to 8, a node 3 more
  pthread_attr_t small;
  pthread_attr_init(&small);
  pthread_attr_setstacksize(&small, PTHREAD_STACK_MIN);
  std::atomic<bool> over{false};
  const auto wait = [](void* flag) -> void* {
    static_cast<std::atomic<bool>*>(flag)->wait(false);
    return nullptr;
  };
  std::vector<pthread_t> started;
  pthread_t one{};
  while (started.size() < kNeeded && pthread_create(&one, &small, wait, &over) == 0)
    started.push_back(one);
  over = true;
  over.notify_all();
  for (const pthread_t thread : started)
    pthread_join(thread, nullptr);
  pthread_attr_destroy(&small);
  if (started.size() < kNeeded)
    throw Error("This process can start " + std::to_string(started.size()) +
                " more threads, DDS needs " + std::to_string(kNeeded) +
                ". Raise the process limit (`ulimit -u`) or pids.max of the container");
}

/// The setting to change, chosen by the message of DDS.
std::string start_remedy(std::string_view cause) {
  if (cause.contains("receive buffer"))
    return "allow larger socket buffers (`sysctl net.core.rmem_max`) or request less in "
           "CYCLONEDDS_URI";
  if (cause.contains("config: ") || cause.contains("CycloneDDS/"))
    return "correct CYCLONEDDS_URI, or unset it";
  if (cause.contains("out of range"))
    return "choose a smaller --domain, or set its ports in CYCLONEDDS_URI (Discovery/Ports)";
  if (cause.contains("participant index"))
    return "end other DDS processes of this domain, or choose another --domain";
  if (cause.contains("bind") || cause.contains("port"))
    return "the port is in use: end that process, or choose another --domain";
  return "`ip link` lists the interfaces, --interface selects one";
}

/// DDS prints the same message for every card that it cannot use.
struct CardFault {
  std::string cause, remedy;
};
std::optional<CardFault> card_fault(const std::string& name) {
  const std::vector<Card> up = network_cards();
  if (name == kThisHost)
    return up.empty() ? std::optional(CardFault{"no network card is up, not even loopback",
                                                "`ip link set lo up`"})
                      : std::nullopt;
  if (std::ranges::find(up, name, &Card::name) != up.end())
    return std::nullopt;
  if (if_nametoindex(name.c_str()) == 0)
    return CardFault{"there is no network card of this name",
                     "`ip link` lists the interfaces, --interface selects one"};
  return CardFault{"the network card is down or has no IPv4 address",
                   "`ip link set " + name + " up`, and `ip addr` lists its addresses"};
}

std::string start_fault(const ParticipantOptions& options, const std::string& cause) {
  const std::optional<CardFault> card =
      cause.contains("interface") ? card_fault(options.network_interface) : std::nullopt;
  return "Cannot start DDS participant '" + options.name + "' on domain " +
         std::to_string(options.domain) + ", interface '" + options.network_interface +
         "': " + (card ? card->cause : cause) +
         ". Remedy: " + (card ? card->remedy : start_remedy(cause));
}

/// The first participant of a process configures its domain. Nodes composed into one process use
/// the same domain.
void configure_domain(const ParticipantOptions& options) {
  static std::mutex mutex;
  static std::map<std::uint32_t, ParticipantOptions> configured;
  const std::lock_guard lock(mutex);
  dds_set_log_sink(log_from_dds, nullptr);
  require_descriptors();
  require_threads();
  const auto settings = [](const ParticipantOptions& o) {
    return std::tie(o.network_interface, o.discovery_peers, o.security);
  };
  if (const auto known = configured.find(options.domain); known != configured.end()) {
    // Mixing participants with and without DDS Security crashes Cyclone DDS 0.10.2. Of two
    // certificates, the second would get the rights of the first.
    if (settings(known->second) != settings(options))
      throw Error(
          "domain " + std::to_string(options.domain) +
          " already runs in this process with different network settings or keys than on '" +
          options.network_interface + "'");
    return;
  }
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  const Network network =
      network_of(options.network_interface, options.discovery_peers, uri ? uri : "");
  const std::vector<int> before = udp_sockets();
  start_lines().clear();
  const dds_entity_t domain = dds_create_domain(options.domain, network.configuration.c_str());
  if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET)
    throw Error(start_fault(options, start_lines().text(domain)));
  if (!uri || !names_cards(uri)) {
    std::vector<Card> used = network_cards();
    if (options.network_interface == kThisHost)
      used = cards_of_this_host(used);
    else
      std::erase_if(used, [&](const Card& card) { return card.name != options.network_interface; });
    note_addresses(used);
  }
  if (network.is_closed) {
    std::vector<int> sockets = udp_sockets();
    std::erase_if(sockets, [&](int fd) { return std::ranges::find(before, fd) != before.end(); });
    close_to_other_hosts(sockets);
  }
  configured[options.domain] = options;
}

}  // namespace

Participant::Participant(const ParticipantOptions& options) {
  configure_domain(options);
  const qos::Qos qos(dds_create_qos());
  static constexpr char kEnclave[] = "enclave=/;voxtouch=1;";
  dds_qset_userdata(qos.get(), kEnclave, sizeof(kEnclave) - 1);
  dds_qset_entity_name(qos.get(), options.name.c_str());
  for (const auto& [name, value] : options.security)
    dds_qset_prop(qos.get(), name.c_str(), value.c_str());
  start_lines().clear();
  const dds_entity_t participant = dds_create_participant(options.domain, qos.get(), nullptr);
  if (participant < 0)
    throw Error(start_fault(options, start_lines().text(participant)));
  entity_ = Entity(participant, "");
  dds_guid_t guid{};
  dds_get_guid(entity_.get(), &guid);
  std::memcpy(guid_.data(), guid.v, guid_.size());
  if (!options.node.name.empty())
    graph_ = std::make_shared<Graph>(entity_.get(), options.node);
  if (graph_ && options.security.empty())
    graph_->read_names();
}

}  // namespace voxtouch::bus

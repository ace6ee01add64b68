#include "nodes/bus/participant.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <tuple>
#include <vector>

#include "nodes/bus/network.hpp"
#include "nodes/log/few_a_second.hpp"
#include "nodes/log/tell.hpp"
#include "qos/profiles.hpp"

namespace voxtouch::bus {
namespace {

/// What DDS has to say, with its time and thread in front: its own way to stderr would hold up the
/// thread that receives. It has a line for every malformed datagram, so anybody who sends such
/// could fill a disk with them. Our configuration sets up no tracing, for DDS writes what it traces
/// by itself.
void say(void*, const dds_log_data_t* data) {
  static log::FewASecond few(4);
  const auto [is_said, left_out] =
      few.take(std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
  if (left_out > 0)
    log::tell("({} more lines of DDS are left out here)\n", left_out);
  if (!is_said && (data->priority & DDS_LC_FATAL) == 0)
    return;
  log::tell("{}\n", std::string_view(data->message - data->hdrsize, data->hdrsize + data->size));
}

/// DDS opens sockets, wait sets and files as it starts, and dies where it gets none; it waits by
/// select, which takes no descriptor beyond FD_SETSIZE. The soft limit is only a default and is
/// raised.
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
    throw Error("this process can open " + std::to_string(taken.size()) +
                " more files and sockets, and DDS needs " + std::to_string(kNeeded) +
                ": allow it more (`ulimit -n` says how many; " + std::to_string(limit.rlim_max) +
                " is the most here) or have fewer open when it starts");
}

/// A domain is configured once a process, before its first participant; nodes composed into one
/// process share it.
void configure_domain(const ParticipantOptions& options) {
  static std::mutex mutex;
  static std::map<std::uint32_t, ParticipantOptions> configured;
  const std::lock_guard lock(mutex);
  dds_set_log_sink(say, nullptr);
  require_descriptors();
  const auto settings = [](const ParticipantOptions& o) {
    return std::tie(o.network_interface, o.discovery_peers, o.security);
  };
  if (const auto known = configured.find(options.domain); known != configured.end()) {
    // One with DDS Security beside one without crashes in Cyclone DDS 0.10.2, and of two
    // certificates the second has the first one's rights.
    if (settings(known->second) != settings(options))
      throw Error("domain " + std::to_string(options.domain) +
                  " already runs in this process with other network settings or keys than on '" +
                  options.network_interface + "'");
    return;
  }
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  const Network network =
      network_of(options.network_interface, options.discovery_peers, uri ? uri : "");
  const std::vector<int> before = udp_sockets();
  const dds_entity_t domain = dds_create_domain(options.domain, network.configuration.c_str());
  if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET)
    throw Error("DDS domain " + std::to_string(options.domain) +
                " could not be set up on interface '" + options.network_interface +
                "' (DDS says: " + dds_strretcode(-domain) + "); `ip link` lists the interfaces");
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
  static constexpr char kEnclave[] = "enclave=/;";
  dds_qset_userdata(qos.get(), kEnclave, sizeof(kEnclave) - 1);
  dds_qset_entity_name(qos.get(), options.name.c_str());
  for (const auto& [name, value] : options.security)
    dds_qset_prop(qos.get(), name.c_str(), value.c_str());
  entity_ =
      Entity(dds_create_participant(options.domain, qos.get(), nullptr),
             "node '" + options.name + "' could not join DDS domain " +
                 std::to_string(options.domain) + " on interface '" + options.network_interface +
                 "'; `ip link` lists the interfaces, --interface chooses one");
  dds_guid_t guid{};
  dds_get_guid(entity_.get(), &guid);
  std::memcpy(guid_.data(), guid.v, guid_.size());
  if (!options.node.name.empty())
    graph_ = std::make_shared<Graph>(entity_.get(), options.node);
}

}  // namespace voxtouch::bus

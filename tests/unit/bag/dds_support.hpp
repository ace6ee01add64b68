#pragma once
/// DDS for tests: on loopback only, on a private domain of this process, with two participants
/// connected over the wire.
#include <dds/dds.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/process/process.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag::test {

/// Cyclone DDS delivers within a domain of one process without the network. Two domain objects with
/// the same number on the wire make two participants that only meet through UDP on `lo`.
class TwoHosts {
 public:
  TwoHosts() {
    const auto wire = static_cast<dds_domainid_t>(std::stoul(voxtouch::test::fresh_domain()));
    const std::string config =
        R"(<General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>
      <AllowMulticast>spdp</AllowMulticast></General><Discovery><ExternalDomainId>)" +
        std::to_string(wire) +
        R"(</ExternalDomainId><SPDPInterval>100 ms</SPDPInterval></Discovery>)";
    for (dds_domainid_t i = 0; i < 2; ++i) {
      domains_[i] = dds_create_domain(wire + i, config.c_str());
      participants_[i] = dds_create_participant(wire + i, nullptr, nullptr);
      if (participants_[i] < 0)
        throw std::runtime_error(std::string("no participant on lo: ") +
                                 dds_strretcode(participants_[i]));
    }
  }
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;
  ~TwoHosts() {
    for (const dds_entity_t domain : domains_)
      dds_delete(domain);
  }
  dds_entity_t here() const { return participants_[0]; }
  dds_entity_t there() const { return participants_[1]; }

 private:
  dds_entity_t domains_[2]{}, participants_[2]{};
};

/// A topic name that no other running test uses.
inline std::string topic_name(const char* base) {
  return "rt/bag_test_" + std::to_string(getpid()) + "/" + base;
}

/// Waits up to 10 s for events that usually take milliseconds.
inline bool eventually(const std::function<bool()>& happened) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!happened()) {
    if (std::chrono::steady_clock::now() > end)
      return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

inline bool matched(dds_entity_t reader_or_writer) {
  dds_publication_matched_status_t publication{};
  dds_subscription_matched_status_t subscription{};
  if (dds_get_publication_matched_status(reader_or_writer, &publication) == DDS_RETCODE_OK)
    return publication.current_count > 0;
  return dds_get_subscription_matched_status(reader_or_writer, &subscription) == DDS_RETCODE_OK &&
         subscription.current_count > 0;
}

inline dds_entity_t make_writer(dds_entity_t participant, const dds_topic_descriptor_t& type,
                                const std::string& name, const dds_qos_t* qos) {
  const dds_entity_t topic = dds_create_topic(participant, &type, name.c_str(), nullptr, nullptr);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, nullptr);
  EXPECT_GT(writer, 0) << dds_strretcode(writer);
  return writer;
}

/// CDR by hand, after the standard (XCDR1, little-endian), independent of the project's code.
class CdrBuilder {
 public:
  template <class T>
  CdrBuilder& add(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0)
      bytes_.push_back({});
    std::byte raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
    return *this;
  }
  CdrBuilder& add_text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    for (const char c : text)
      bytes_.push_back(static_cast<std::byte>(c));
    bytes_.push_back({});
    return *this;
  }
  /// The protocol sends multiples of 4; the last bits of Cyclone DDS's header have the number of
  /// padding bytes.
  std::vector<std::byte> padded() const {
    auto bytes = bytes_;
    while (bytes.size() % 4 != 0)
      bytes.push_back({});
    bytes[3] = static_cast<std::byte>(bytes.size() - bytes_.size());
    return bytes;
  }

 private:
  std::vector<std::byte> bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

}  // namespace voxtouch::bag::test

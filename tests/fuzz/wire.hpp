#pragma once
/// Messages as they come from the network: the house's raw writer sends whatever bytes there are, Cyclone DDS reads them into the type
/// as for any sender, or drops them, and the house's reader hands out what is left.
#include <dds/dds.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "nodes/bus/opaque.hpp"
#include "nodes/bus/reader.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::fuzz {

/// One participant that meets nobody: a domain of its own without multicast.
inline dds_entity_t participant() {
  static const dds_entity_t it = [] {
    constexpr dds_domainid_t kDomain = 191;
    constexpr const char* kAlone =
        "<General><Interfaces><NetworkInterface "
        "name='lo'/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
        "<Tracing><Verbosity>none</Verbosity></Tracing><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>100</MaxAutoParticipantIndex></"
        "Discovery>";
    if (dds_create_domain(kDomain, kAlone) < 0) std::abort();
    const dds_entity_t made = dds_create_participant(kDomain, nullptr, nullptr);
    if (made < 0) std::abort();
    return made;
  }();
  return it;
}

template <class T>
class Wire {
 public:
  Wire() {
    const std::string name = "fuzz_" + std::to_string(getpid());
    const std::string type(msg::Type<T>::dds_name);
    auto raw = bus::OpaqueTopic::create(participant(), name, type);
    if (!raw) broken("the raw topic can be made", __FILE__, __LINE__);
    raw_ = std::make_unique<bus::OpaqueTopic>(std::move(*raw));
    auto writer = bus::OpaqueWriter::create(*raw_, bus::EndpointQos{});
    if (!writer) broken("the raw writer can be made", __FILE__, __LINE__);
    writer_ = std::make_unique<bus::OpaqueWriter>(std::move(*writer));
    const dds_entity_t topic =
        dds_create_topic(participant(), msg::Type<T>::descriptor, name.c_str(), nullptr, nullptr);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    reader_ = dds_create_reader(participant(), topic, qos, nullptr);
    dds_delete_qos(qos);
    if (reader_ < 0) broken("the reader can be made", __FILE__, __LINE__);
    while (writer_->matched_readers() == 0) dds_sleepfor(DDS_MSECS(1));
  }

  /// `cdr`: encapsulation header and body. Calls f(const T&) where it can be read as a T; false where not.
  template <class F>
  bool through(std::string_view cdr, F&& f) {
    if (!writer_->write(std::as_bytes(std::span(cdr)))) return false;
    void* lent[1] = {nullptr};
    dds_sample_info_t info;
    if (dds_take(reader_, lent, &info, 1, 1) != 1) return false;
    if (info.valid_data) f(*static_cast<const T*>(lent[0]));
    dds_return_loan(reader_, lent, 1);
    return info.valid_data;
  }

 private:
  std::unique_ptr<bus::OpaqueTopic> raw_;
  std::unique_ptr<bus::OpaqueWriter> writer_;
  dds_entity_t reader_ = 0;
};

/// Types of fixed size: the input is one message after the other, each as little-endian CDR without its header.
template <class T, class F>
void each_message(Wire<T>& wire, const std::uint8_t* data, std::size_t size, F&& f) {
  constexpr std::size_t kMost = 64;  // more say no more, and take time
  Bytes in(data, size);
  for (std::size_t n = 0; n < kMost && !in.empty(); ++n) {
    std::string cdr("\0\1\0\0", 4);
    cdr += in.take(sizeof(T));
    wire.through(cdr, f);
  }
}

}  // namespace voxtouch::fuzz

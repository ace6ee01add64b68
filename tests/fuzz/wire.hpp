#pragma once
/// Messages from the network: Cyclone DDS decodes the bytes as for any sender, or drops them.
#include <dds/dds.h>

#include <string>

#include "nodes/bus/wire_form.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace voxtouch::fuzz {

/// An isolated participant: a separate domain without multicast.
inline dds_entity_t participant() {
  static const dds_entity_t it = [] {
    constexpr dds_domainid_t kDomain = 191;
    constexpr const char* kAlone =
        "<General><Interfaces><NetworkInterface "
        "name='lo'/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
        "<Tracing><Verbosity>none</Verbosity></Tracing><Discovery><ParticipantIndex>auto</"
        "ParticipantIndex><MaxAutoParticipantIndex>100</MaxAutoParticipantIndex></"
        "Discovery>";
    if (dds_create_domain(kDomain, kAlone) < 0)
      std::abort();
    const dds_entity_t made = dds_create_participant(kDomain, nullptr, nullptr);
    if (made < 0)
      std::abort();
    return made;
  }();
  return it;
}

template <class T>
class Wire {
 public:
  /// `cdr`: encapsulation header and body. Calls f(const T&) if it decodes as a T; otherwise
  /// returns false.
  template <class F>
  bool through(std::string_view cdr, F&& f) {
    return form_.read(cdr, f);
  }

 private:
  bus::WireForm<T> form_{participant()};
};

/// Types of fixed size: the input is one message after the other, each as little-endian CDR without
/// its header.
template <class T, class F>
void each_message(Wire<T>& wire, const std::uint8_t* data, std::size_t size, F&& f) {
  constexpr std::size_t kMaxPieces = 64;  // more add no coverage, only time
  Bytes in(data, size);
  for (std::size_t n = 0; n < kMaxPieces && !in.empty(); ++n) {
    std::string cdr("\0\1\0\0", 4);
    cdr += in.take(sizeof(T));
    wire.through(cdr, f);
  }
}

}  // namespace voxtouch::fuzz

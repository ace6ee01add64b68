#pragma once
/// Decodes messages from the bytes of a bag without a participant, by the CDR reader of Cyclone
/// DDS. The type description is sufficient for it.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>

#include <cstring>
#include <span>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

constexpr std::size_t kCdrHeader = 4;

/// Streams of the ring have fixed size and no padding, so their CDR equals the struct. Returns
/// false for an invalid message.
template <class T>
bool read_stream(std::span<const std::byte> bytes, T& message) {
  if (bytes.size() != sizeof message + kCdrHeader)
    return false;
  std::memcpy(&message, bytes.data() + kCdrHeader, sizeof message);
  return true;
}

/// Calls f(const T&) for a message with texts. Returns false, without a call, for an invalid
/// message. Allocates.
template <class T, class F>
bool read_message(std::span<const std::byte> bytes, F&& f) {
  if (bytes.size() < kCdrHeader)
    return false;
  const auto encoding = std::to_integer<unsigned>(bytes[1]);
  if (bytes[0] != std::byte{0} || encoding > 1)
    return false;  // plain CDR, big or little endian, as written by ROS 2 and Cyclone DDS
  const auto* ops = msg::Type<T>::descriptor->m_ops;
  std::vector<char> body(bytes.size() - kCdrHeader + 8);  // DDS reads whole words, so the buffer
                                                          // has padding at its end
  std::memcpy(body.data(), bytes.data() + kCdrHeader, bytes.size() - kCdrHeader);
  std::uint32_t end = 0;
  const auto size = static_cast<std::uint32_t>(bytes.size() - kCdrHeader);
  constexpr std::uint32_t kPlain = 1;  // XCDR version 1
  if (!dds_stream_normalize_data(body.data(), &end, size, encoding == 0, kPlain, ops))
    return false;
  dds_istream_t in;
  dds_istream_init(&in, size, body.data(), kPlain);
  T message{};
  dds_stream_read(&in, reinterpret_cast<char*>(&message), ops);
  f(static_cast<const T&>(message));
  dds_sample_free(&message, msg::Type<T>::descriptor, DDS_FREE_CONTENTS);
  return true;
}

}  // namespace voxtouch::bus

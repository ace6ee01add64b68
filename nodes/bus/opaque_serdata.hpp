#pragma once
/// Cyclone DDS's view of a type that nobody knows: a sertype with a name only, a serdata that is a block of
/// CDR bytes. Internal to nodes/bus/opaque*.cpp.
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace voxtouch::bus {

/// What dds_write_ts gets as its "sample": the serialised message, encapsulation header included.
using OpaqueBytes = std::span<const std::byte>;

/// Bytes of one message, header included, behind the fields that Cyclone DDS keeps. Freed by its reference
/// count.
struct OpaqueSerdata : ddsi_serdata {
  std::int64_t reception_time_ns = 0;  ///< wall clock when the bytes reached this process's cache
  std::uint32_t byte_count = 0;        ///< without the padding to 4 that the protocol may read beyond the end
  std::byte* data = nullptr;           ///< inside the same allocation

  OpaqueBytes bytes() const noexcept { return {data, byte_count}; }
};

/// A new keyless sertype of that name; hand it to dds_create_topic_sertype, or to ddsi_sertype_unref if that
/// fails.
ddsi_sertype* make_opaque_sertype(const char* type_name);

/// The serdata that a takecdr on an opaque reader returned.
const OpaqueSerdata& as_opaque(const ddsi_serdata* serdata) noexcept;

}  // namespace voxtouch::bus

#pragma once
/// QoS of one endpoint as a plain value: what discovery tells of a writer, what a bag stores, what an opaque
/// endpoint asks for. No DDS header here, so that the bag knows it without knowing DDS.
#include <cstdint>
#include <limits>

namespace voxtouch::bus {

enum class Reliability : std::uint8_t { kBestEffort, kReliable };
/// kTransient and kPersistent are matched by Cyclone DDS 0.10 but not kept beyond the writer's life.
enum class Durability : std::uint8_t { kVolatile, kTransientLocal, kTransient, kPersistent };
enum class History : std::uint8_t { kKeepLast, kKeepAll };
enum class Liveliness : std::uint8_t { kAutomatic, kManualByParticipant, kManualByTopic };

/// Durations in ns; this value means for ever.
inline constexpr std::int64_t kInfiniteNs = std::numeric_limits<std::int64_t>::max();

/// The policies of an endpoint that decide whether two match and what is kept. Defaults: a best-effort,
/// volatile, keep-last-1 endpoint without deadline, which as a reader matches every writer.
struct EndpointQos {
  Reliability reliability = Reliability::kBestEffort;
  Durability durability = Durability::kVolatile;
  History history = History::kKeepLast;
  std::int32_t depth = 1;                      ///< kept samples with kKeepLast, >= 1; ignored with kKeepAll
  std::int32_t max_samples = -1;               ///< bound of kKeepAll; -1: none
  std::int64_t max_blocking_ns = 100'000'000;  ///< how long a reliable write may wait for room
  std::int64_t deadline_ns = kInfiniteNs;
  std::int64_t lifespan_ns = kInfiniteNs;  ///< writers only
  Liveliness liveliness = Liveliness::kAutomatic;
  std::int64_t lease_ns = kInfiniteNs;
  bool operator==(const EndpointQos&) const = default;
};

/// What a recorder asks for to get everything that `writer` offers: the same reliability and durability (a
/// reader that does not ask for transient local gets nothing of what is latched), no deadline and no lease
/// (those would report faults that are the ring's business), the last `depth` samples so that a slow recorder
/// never blocks a reliable writer.
EndpointQos recorder_qos(const EndpointQos& writer, std::int32_t depth = 1024) noexcept;

}  // namespace voxtouch::bus

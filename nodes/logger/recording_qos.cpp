#include "nodes/logger/recording_qos.hpp"

#include <fmt/format.h>

namespace voxtouch::logger {
namespace {

// An infinite duration is the largest int64 in ns, which rmw splits in the same way.
std::string duration(dds_duration_t ns) {
  return fmt::format("\n    sec: {}\n    nsec: {}", ns / 1'000'000'000, ns % 1'000'000'000);
}

/// The policies that determine whether a reader matches. A policy that the writer did not announce
/// has the default of DDS.
struct Match {
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  explicit Match(const dds_qos_t* qos) {
    dds_duration_t blocking = 0;
    dds_qget_reliability(qos, &reliability, &blocking);
    dds_qget_durability(qos, &durability);
  }
  bool reliable() const { return reliability == DDS_RELIABILITY_RELIABLE; }
  /// Includes transient and persistent, for which rmw has no number; for a late reader they are
  /// equivalent.
  bool latched() const { return durability != DDS_DURABILITY_VOLATILE; }
};

}  // namespace

std::string offered_qos_text(const dds_qos_t* writer) {
  const Match match(writer);
  dds_history_kind_t history = DDS_HISTORY_KEEP_LAST;
  std::int32_t depth = 1;
  dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
  dds_duration_t deadline = DDS_INFINITY, lifespan = DDS_INFINITY, lease = DDS_INFINITY;
  dds_qget_history(writer, &history, &depth);
  dds_qget_liveliness(writer, &liveliness, &lease);
  dds_qget_deadline(writer, &deadline);
  dds_qget_lifespan(writer, &lifespan);
  const bool keep_all = history == DDS_HISTORY_KEEP_ALL;
  return fmt::format(
      "- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n  deadline:{}\n  "
      "lifespan:{}\n  liveliness: {}\n"
      "  liveliness_lease_duration:{}\n  avoid_ros_namespace_conventions: false",
      keep_all ? 2 : 1, keep_all ? 0 : depth, match.reliable() ? 1 : 2, match.latched() ? 1 : 2,
      duration(deadline), duration(lifespan), static_cast<int>(liveliness) + 1,
      duration(lease));  // numbers of rmw/types.h
}

qos::Qos recording_qos(const dds_qos_t* writer) {
  const Match match(writer);
  qos::Profile profile = qos::profile(qos::ProfileId::kTap);
  profile.reliable = match.reliable();
  profile.transient_local = match.latched();
  profile.depth = 4096;
  return qos::make_qos(profile, qos::Endpoint::kReader, 0.0);
}

}  // namespace voxtouch::logger

#include "qos/profiles.hpp"

#include <cmath>

namespace voxtouch::qos {

Qos make_qos(const Profile& p, Endpoint endpoint, double period_s) {
  Qos qos(dds_create_qos());
  // Time for which a full history blocks a writer; in lockstep nodes retry (Writer::write_until).
  // Topics for display never block a writer.
  const bool is_for_others =
      p.id == ProfileId::kState || p.id == ProfileId::kService || p.id == ProfileId::kLog;
  const dds_duration_t blocking = is_for_others ? 0 : DDS_MSECS(100);
  dds_qset_reliability(
      qos.get(), p.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, blocking);
  dds_qset_durability(qos.get(),
                      p.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  // A status writer keeps its own last value; its readers keep one for each of many writers.
  const std::int32_t depth =
      p.id == ProfileId::kStatus && endpoint == Endpoint::kWriter ? 1 : p.depth;
  if (p.keep_all) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(qos.get(), depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  }
  if (p.transient_local && endpoint == Endpoint::kWriter)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  if (p.deadline_periods > 0 && period_s > 0)
    dds_qset_deadline(
        qos.get(), static_cast<dds_duration_t>(std::llround(p.deadline_periods * period_s * 1e9)));
  dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
  dds_qset_latency_budget(qos.get(), 0);
  if (endpoint == Endpoint::kWriter)
    dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

}  // namespace voxtouch::qos

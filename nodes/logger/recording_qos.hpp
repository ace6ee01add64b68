#pragma once
/// QoS of a recording: the offered QoS stored in a bag, and the QoS requested by its readers.
#include <string>

#include "qos/profiles.hpp"

namespace voxtouch::logger {

/// The text that metadata versions 4 to 8 store for a writer: a YAML list with the numbers of rmw.
std::string offered_qos_text(const dds_qos_t* writer);

/// QoS of a reader that receives everything that `writer` offers.
/// Reliability and durability equal those of the writer; without transient local, a reader would
/// miss latched values. Deadline and lease are unlimited, because violations concern the ring only.
/// The history is deep, so that a slow recorder does not block a reliable writer.
qos::Qos recording_qos(const dds_qos_t* writer);

}  // namespace voxtouch::logger

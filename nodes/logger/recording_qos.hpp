#pragma once
/// The QoS of a recording: what a bag says of a topic's writers, and what a reader asks of them.
#include <string>

#include "qos/profiles.hpp"

namespace voxtouch::logger {

/// The text that metadata version 4 to 8 stores for a writer: a YAML list with rmw's numbers.
std::string offered_qos_text(const dds_qos_t* writer);

/// What gets everything that `writer` offers: the same reliability and durability (a reader that
/// does not ask for transient local gets nothing of what is latched), no deadline and no lease
/// (those would report faults that are the ring's business), and many last samples, so that a slow
/// recorder never blocks a reliable writer.
qos::Qos recording_qos(const dds_qos_t* writer);

}  // namespace voxtouch::logger

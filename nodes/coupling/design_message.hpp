#pragma once
/// The coupling that runs, as a latched message.
#include "core/coupling/coupling_spec.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::coupling {

void publish_design(bus::Writer<msg::CouplingDesign>& writer, const CouplingSpec& spec, std::uint64_t session,
                    double sample_time_s);

}  // namespace voxtouch::coupling

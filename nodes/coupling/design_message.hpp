#pragma once
/// The coupling that runs, and what vouches for it, as a latched message.
#include "core/fitting/fit_coupling.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::coupling_node {

/// "configured" for a coupling that is set by hand, else the designer's word.
std::string status_word(const fitting::FittedCoupling& fitted);

/// The message without its texts and its session.
msg::CouplingDesign design_numbers(const fitting::FittedCoupling& fitted, double sample_time_s);

/// `external`: name of the effect that no certificate covers; empty: there is none.
void publish_design(bus::Writer<msg::CouplingDesign>& writer, const fitting::FittedCoupling& fitted,
                    std::uint64_t session, double sample_time_s, const std::string& external);

}  // namespace voxtouch::coupling_node

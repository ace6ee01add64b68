#pragma once
/// Publishes the running coupling and its certificate as a latched message.
#include <string>
#include <vector>

#include "core/device_fit/fit_coupling.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/coupling/contact_coupling.hpp"

namespace voxtouch::coupling_node {

/// "configured" for a manual coupling, otherwise the status of the designer.
std::string status_word(const device_fit::FittedCoupling& fitted);

/// The first sample and the state of an adopted coupling.
struct Adoption {
  std::uint64_t session = 0;
  std::uint64_t from_sample = 0;  ///< the first sample of the session that it may answer
  bool starts_at_rest = false;    ///< without the state of the previous coupling
  AdoptedCoupling coupling;
  double sample_time_s = 0.0;
};

/// Converts to the message, which refers to the text `kind`, and back, bit-identical.
void write_coupling(const Adoption& use, msg::CouplingDesign& message);
Adoption adoption_of(const msg::CouplingDesign& message);

/// Every number in which two couplings or their limits differ, for example "gain 1 recorded, 0.9
/// now".
std::vector<std::string> differences(const AdoptedCoupling& recorded, const AdoptedCoupling& made);

/// `external`: name of the effect that no certificate covers; empty if there is none.
void publish_design(bus::Writer<msg::CouplingDesign>& writer,
                    const device_fit::FittedCoupling& fitted, const Adoption& use,
                    const std::string& external);

}  // namespace voxtouch::coupling_node

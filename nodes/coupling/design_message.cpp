#include "nodes/coupling/design_message.hpp"

#include "nodes/runtime/strings.hpp"

namespace voxtouch::coupling {

void publish_design(bus::Writer<msg::CouplingDesign>& writer, const CouplingSpec& spec, std::uint64_t session,
                    double sample_time_s) {
  const bool filter = spec.kind == "shaping_filter", spring = spec.kind == "spring_damper";
  const std::string status = "configured";
  std::vector<std::string> notes = {"set by hand in the scene; nothing was designed or certified for this device"};
  for (const CouplingIssue& issue : validate(spec, {}, sample_time_s)) notes.push_back(issue.sentence);
  runtime::LentStrings lent(notes);
  msg::CouplingDesign m{};
  m.session_id = session;
  m.kind = runtime::lend(spec.kind);
  m.status = runtime::lend(status);
  m.cutoff_hz = filter ? spec.cutoff_hz : 0.0;
  m.damping_ratio = filter ? spec.damping_ratio : 0.0;
  m.gain = filter ? spec.gain : 1.0;
  m.stiffness_n_per_m = spring ? spec.stiffness_n_per_m : 0.0;
  m.damping_ns_per_m = spring ? spec.damping_ns_per_m : 0.0;
  m.lag_s = lag_s(spec);
  m.sample_time_s = sample_time_s;
  lent.into(m.notes);
  writer.write(m);
}

}  // namespace voxtouch::coupling

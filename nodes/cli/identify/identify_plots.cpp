// The input of the drawing tool for an identification.
#include <nlohmann/json.hpp>

#include "nodes/cli/identify/identify_report.hpp"

namespace voxtouch::cli {
namespace {

namespace id = identification;

nlohmann::json to_json(const id::Estimate& e) { return {e.value, e.half_width}; }

/// The entries of `first` and the parts after it.
nlohmann::json record_json(const std::vector<id::RecordEntry>& record, id::Part first) {
  nlohmann::json out{{"time_s", nlohmann::json::array()},
                     {"position_m", nlohmann::json::array()},
                     {"force_n", nlohmann::json::array()}};
  for (const id::RecordEntry& e : record) {
    if (e.part < first)
      continue;
    out["time_s"].push_back(e.time_s);
    out["position_m"].push_back(e.position_m);
    out["force_n"].push_back(e.force_n);
  }
  return out;
}

nlohmann::json axis_json(const id::AxisFigures& f, const AxisCurves& curves, double step_m) {
  nlohmann::json out{{"mass_kg", to_json(f.mass_kg)},
                     {"viscous_ns_per_m", to_json(f.viscous_ns_per_m)},
                     {"coulomb_n", to_json(f.coulomb_n)},
                     {"bias_n", to_json(f.bias_n)},
                     {"delay_s", to_json(f.delay_s)},
                     {"encoder_step_m", step_m},
                     {"residual_m", f.residual_m},
                     {"mode_hz", f.mode.found ? f.mode.frequency_hz.value : 0.0},
                     {"strokes", nlohmann::json::array()},
                     {"record", record_json(curves.record, id::Part::kStroke)},
                     {"tones", record_json(curves.record, id::Part::kDenseTones)}};
  for (const id::Curve& c : curves.strokes)
    out["strokes"].push_back({{"direction", c.direction},
                              {"start_s", c.start_s},
                              {"time_s", c.times_s},
                              {"position_m", c.position_m},
                              {"residual_m", c.residual_m}});
  return out;
}

}  // namespace

std::string plots_json(const DeviceRunResult& r, const id::SessionOptions& s,
                       const IdentifyContext& c, const std::string& text) {
  nlohmann::json out{
      {"device", c.assumed.model}, {"date", c.date}, {"command", c.command}, {"text", text}};
  out["axes"] = nlohmann::json::object();
  for (std::size_t a = 0; a < 3; ++a)
    if (s.axes[a] && r.axes[a].outcome == id::Outcome::kMeasured)
      out["axes"][std::string(1, "xyz"[a])] =
          axis_json(r.axes[a], r.curves[a], r.encoder_step_m[a]);
  return out.dump();
}

}  // namespace voxtouch::cli

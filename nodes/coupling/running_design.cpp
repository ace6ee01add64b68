#include "nodes/coupling/running_design.hpp"

#include <fmt/format.h>

#include "core/device_fit/design_problem.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::coupling_node {

void RunningDesign::adopt(device_fit::FittedCoupling fitted, Adoption use,
                          const std::optional<device_fit::ForcePreview>& preview,
                          double device_max_n_per_m, const std::string& external) {
  use_ = std::move(use);
  publish_design(designs_, fitted, use_, external);
  const std::lock_guard lock(mutex_);
  fitted_ = std::move(fitted);
  preview_ = preview;
  device_max_n_per_m_ = device_max_n_per_m;
  ++count_;
}

void RunningDesign::report_to(double contact_n_per_m, runtime::NodeReport& report,
                              runtime::StatusText& status) {
  using runtime::StatusPriority;
  const std::lock_guard lock(mutex_);
  // The device's limit applies to the total stiffness of the contact, not to that of one point.
  const double displayed_n_per_m =
      device_fit::stiffness_at_hand_n_per_m(fitted_.spec, mapping_, contact_n_per_m);
  report.figures["stiffness_at_hand_n_per_m"] = {displayed_n_per_m, "N/m"};
  report.figures["device_max_stiffness_n_per_m"] = {device_max_n_per_m_, "N/m"};
  if (count_ == 0)
    return;
  describe(report);
  if (displayed_n_per_m > device_max_n_per_m_)
    status.set(
        StatusPriority::kProgress,
        fmt::format(
            "Contact stiffness at the hand up to {:.0f} N/m, device limit {:.0f} N/m. Reduce the "
            "contact stiffness or coupling.gain, or use coupling: {{design: auto}}",
            displayed_n_per_m, device_max_n_per_m_));
  status.set(StatusPriority::kProgress,
             fmt::format("running {}, {}", fitted_.spec.kind, status_word(fitted_)));
  runtime::report_refusal(design_text::sentence_of(fitted_.refusal), report, status);
}

void RunningDesign::describe(runtime::NodeReport& report) const {
  const coupling::CouplingSpec& spec = fitted_.spec;
  const coupling::design::Design& design = fitted_.design;
  report.values["design_status"] = status_word(fitted_);
  report.values["design_kind"] = spec.kind;
  report.values["design_worst_case"] = design_text::worst_case_of(design, 0);
  report.figures["designs"] = {count_, "designs"};
  report.figures["design_cutoff_hz"] = {spec.kind == "shaping_filter" ? spec.cutoff_hz : 0.0, "Hz"};
  report.figures["design_gain"] = {spec.gain, "1"};
  report.figures["design_injected_damping_ns_per_m"] = {spec.injected_damping_ns_per_m, "Ns/m"};
  report.figures["design_displayed_n_per_m"] = {design.translation.displayed_stiffness, "N/m"};
  report.figures["design_critical_n_per_m"] = {design.translation.critical_stiffness, "N/m"};
  report.figures["design_gain_margin"] = {design.translation.gain_margin, "1"};
  if (!preview_)
    return;
  report.values["stiffness_limit"] = device_fit::name_of(preview_->limit);
  report.figures["certified_stiffness_n_per_m"] = {preview_->stiffness_n_per_m, "N/m"};
  report.figures["saturation_force_n"] = {preview_->force_n, "N"};
  report.values["returns_torque"] = preview_->returns_torque ? "yes" : "no";
  report.figures["saturation_depth_m"] = {preview_->depth_m, "m"};
  report.figures["spring_nm_per_rad"] = {preview_->rotation_nm_per_rad, "Nm/rad"};
  report.figures["requested_grip_n_per_m"] = {preview_->grip_n_per_m, "N/m"};
}

}  // namespace voxtouch::coupling_node

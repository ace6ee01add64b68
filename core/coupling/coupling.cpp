#include "core/coupling/coupling.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "core/coupling/velocity_window.hpp"
#include "core/types/enum_name.hpp"

namespace voxtouch::coupling {
namespace {

constexpr std::array<std::string_view, 3> kNames{"direct", "shaping_filter", "spring_damper"};

class Findings {
 public:
  explicit Findings(std::vector<CouplingIssue>& out) : out_(out) {}
  bool positive(const char* field, double value) {
    return rule(field, value, value > 0.0 && std::isfinite(value), "above 0");
  }
  bool not_negative(const char* field, double value) {
    return rule(field, value, value >= 0.0 && std::isfinite(value), "0 or above");
  }
  bool cap(const char* field, double value) {
    return rule(field, value, value > 0.0, "above 0, infinity for no cap");
  }
  bool window(const char* field, std::uint32_t value) {
    static_assert(kMaxVelocityWindow == 5);
    return rule(field, value, value <= kMaxVelocityWindow, "an integer from 0 to 5");
  }
  bool limit(const char* field, double value) {
    return rule(field, value, value >= 0.0, "0 or above, infinity for no limit");
  }

 private:
  bool rule(const char* field, double value, bool kept, const char* text) {
    if (!kept)
      out_.push_back({field, fmt::format("{} is {}; it must be {}.", field, value, text), true});
    return kept;
  }
  std::vector<CouplingIssue>& out_;
};

void validate_cutoff(const CouplingSpec& spec, double sample_time_s,
                     std::vector<CouplingIssue>& out) {
  const double angle_per_sample = cutoff_rad_per_s(spec) * sample_time_s;
  const auto sentence = [&](const char* rule) {
    return fmt::format("cutoff_hz is {}, so w0*T is {:.3g} at a sample time of {:g} s; {}.",
                       spec.cutoff_hz, angle_per_sample, sample_time_s, rule);
  };
  if (angle_per_sample >= std::numbers::pi) {
    out.push_back({"cutoff_hz",
                   sentence("limit pi (above it the filter oscillates at the sample rate)"), true});
  } else if (angle_per_sample > kWarnCutoffRad) {
    out.push_back(
        {"cutoff_hz",
         sentence("above 0.6 the sampled filter's cut-off is noticeably lower than requested"),
         false});
  }
}

}  // namespace

std::string_view name_of(CouplingKind kind) noexcept { return name_in(kNames, kind); }
bool parse_coupling(std::string_view word, CouplingKind& kind) noexcept {
  return find_name(kNames, word, kind);
}

double cutoff_rad_per_s(const CouplingSpec& spec) noexcept {
  return 2.0 * std::numbers::pi * spec.cutoff_hz;
}

double lag_s(const CouplingSpec& spec) noexcept {
  return spec.kind == name_of(CouplingKind::kShapingFilter)
             ? 2.0 * spec.damping_ratio / cutoff_rad_per_s(spec)
             : 0.0;
}

bool damps_on_slow_velocity(const CouplingSpec& spec) noexcept {
  return spec.slow_velocity_hz > 0.0 && spec.velocity_band_m_per_s > 0.0 &&
         spec.injected_damping_ns_per_m > 0.0;
}

double displayed_stiffness_n_per_m(const CouplingSpec& spec, double contact_n_per_m) noexcept {
  if (contact_n_per_m > spec.stiffness_cap_n_per_m)
    contact_n_per_m = spec.stiffness_cap_n_per_m;
  if (spec.kind == name_of(CouplingKind::kShapingFilter))
    return spec.gain * contact_n_per_m;
  if (spec.kind == name_of(CouplingKind::kSpringDamper))
    return spec.stiffness_n_per_m * (contact_n_per_m / (spec.stiffness_n_per_m + contact_n_per_m));
  return contact_n_per_m;
}

std::vector<CouplingIssue> validate(const CouplingSpec& spec, const CouplingLimits& limits,
                                    double sample_time_s) {
  std::vector<CouplingIssue> out;
  Findings find(out);
  CouplingKind kind{};
  if (!parse_coupling(spec.kind, kind)) {
    out.push_back({"kind",
                   fmt::format("kind is '{}'; it must be shaping_filter, spring_damper or direct.",
                               spec.kind),
                   true});
    return out;
  }
  const bool period = find.positive("sample_time_s", sample_time_s);
  find.limit("max_force_n", limits.max_force_n);
  find.limit("max_torque_nm", limits.max_torque_nm);
  if (kind == CouplingKind::kShapingFilter) {
    const bool cutoff = find.positive("cutoff_hz", spec.cutoff_hz);
    find.positive("damping_ratio", spec.damping_ratio);
    find.not_negative("gain", spec.gain);
    if (cutoff && period)
      validate_cutoff(spec, sample_time_s, out);
  } else if (kind == CouplingKind::kSpringDamper) {
    find.positive("stiffness_n_per_m", spec.stiffness_n_per_m);
    find.not_negative("damping_ns_per_m", spec.damping_ns_per_m);
  }
  find.cap("stiffness_cap_n_per_m", spec.stiffness_cap_n_per_m);
  find.cap("stiffness_cap_nm_per_rad", spec.stiffness_cap_nm_per_rad);
  find.not_negative("injected_damping_ns_per_m", spec.injected_damping_ns_per_m);
  find.not_negative("injected_damping_nms_per_rad", spec.injected_damping_nms_per_rad);
  find.positive("velocity_filter_hz", spec.velocity_filter_hz);
  find.window("velocity_window", spec.velocity_window);
  find.not_negative("slow_velocity_hz", spec.slow_velocity_hz);
  find.not_negative("velocity_band_m_per_s", spec.velocity_band_m_per_s);
  find.not_negative("damping_force_ratio", spec.damping_force_ratio);
  find.not_negative("damping_force_offset_n", spec.damping_force_offset_n);
  return out;
}

}  // namespace voxtouch::coupling

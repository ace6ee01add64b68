#include "nodes/cli/design/certificate_report.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace voxtouch::cli {
namespace {

namespace cd = coupling::design;

constexpr std::array<std::string_view, 2> kStiffnessUnits{"N/m", "Nm/rad"};

/// "518 N/m, margin 1.98; 2.1 Nm/rad, margin 2.4".
std::string certified_limits(const cd::ContactCertificate& c) {
  std::string text;
  for (std::size_t a = 0; a < c.axes.size(); ++a) {
    const double promised = c.axes[a].stiffness / c.axes[a].margin;
    text += fmt::format("{}{:.4g} {}, margin {:.3g}", a == 0 ? "" : "; ", promised,
                        kStiffnessUnits[a], c.axes[a].margin);
  }
  return text;
}

/// Why it is not for any contact.
std::string linear_reason(const cd::ContactCertificate& c) {
  if (c.loops == 0)
    return "not any contact: the passivity rule for any hand allows less than the displayed "
           "stiffness";
  if (c.ratio_of_linear == 0.0)
    return "not any contact: no multiplier found";
  std::string text = "not any contact: a multiplier exists only up to ";
  for (std::size_t a = 0; a < c.axes.size(); ++a)
    text +=
        fmt::format("{}{:.4g} {}", a == 0 ? "" : " and ", c.axes[a].stiffness, kStiffnessUnits[a]);
  return text;
}

std::string_view gap_sentence(cd::CertificateGap gap) {
  switch (gap) {
    using enum cd::CertificateGap;
    case kDamperGate:
      return "Injected damping acts only in contact, along the force; the certificate assumes it "
             "always acts.";
    case kDamperBound:
      return "Injected damping is limited to a ratio of the contact force; the certificate assumes "
             "no limit.";
    case kVelocityBand:
      return "Damping switches between two velocity estimates; each is certified, the switch is "
             "not.";
    case kVaryingTiming:
      return "The nominal and the slowest timing are certified as constant; real jitter and losses "
             "vary.";
    case kBetweenCorners:
      return "The ends of the mass and hand ranges are certified, not every value between them.";
    case kReleasedFrictionless:
      return "Released and out of contact, a device without viscous damping does not come to rest.";
    case kForceOnlyLever:
      return "A contact away from the hand rotates the tool; the device returns no torque against "
             "that.";
    case kCurvedContact:
      return "On a curved surface the force direction changes with position: a negative stiffness "
             "of F/R.";
    case kVoxelSteps:
      return "The contact force may step when a point of the tool enters a voxel.";
    case kEncoderSteps:
      return "Encoder quantisation may sustain a small limit cycle.";
    case kForceLimit:
      return "Above the device's largest force the actuator saturates; that loop is not certified.";
  }
  return "";
}

nlohmann::ordered_json finite_or_null(double v) {
  return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json();
}

nlohmann::ordered_json multiplier_json(const cd::Multiplier& m) {
  double all = m.at_rest;
  for (std::size_t i = 0; i < cd::Multiplier::kReach; ++i)
    all += m.past[i] + m.future[i];
  nlohmann::ordered_json j;
  for (const double weight : m.past)
    j["past"].push_back(weight / all);
  for (const double weight : m.future)
    j["future"].push_back(weight / all);
  j["at_rest"] = m.at_rest / all;
  return j;
}

}  // namespace

std::string certificate_line(const cd::ContactCertificate& c) {
  if (c.contact == cd::ContactClass::kMonotone)
    return "any contact whose force does not decrease with depth, up to " + certified_limits(c);
  if (c.contact == cd::ContactClass::kLinear)
    return "linear contact up to the displayed stiffness; " + linear_reason(c);
  return "";
}

std::vector<std::string> certificate_gaps(const cd::ContactCertificate& c) {
  std::vector<std::string> out;
  for (const cd::CertificateGap gap : c.gaps)
    out.emplace_back(gap_sentence(gap));
  return out;
}

nlohmann::ordered_json certificate_json(const cd::ContactCertificate& c) {
  nlohmann::ordered_json j{{"contact", cd::name_of(c.contact)}, {"proof", cd::name_of(c.proof)}};
  for (std::size_t a = 0; a < c.axes.size(); ++a)
    j[a == 0 ? "translation" : "rotation"] = {{"stiffness", finite_or_null(c.axes[a].stiffness)},
                                              {"margin", finite_or_null(c.axes[a].margin)}};
  j["ratio_of_linear"] = c.ratio_of_linear;
  j["loops"] = c.loops;
  if (c.ratio_of_linear > 0.0)
    j["multiplier"] = multiplier_json(c.multiplier);
  j["leaves_out"] = nlohmann::ordered_json::array();
  for (const cd::CertificateGap gap : c.gaps)
    j["leaves_out"].push_back(cd::name_of(gap));
  return j;
}

}  // namespace voxtouch::cli

#include "nodes/cli/force_line.hpp"

#include <utility>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

/// Below this fraction of the certified stiffness the difference is reported.
constexpr double kAlmost = 0.99;

const char* words_for(device_fit::StiffnessLimit limit) {
  using enum device_fit::StiffnessLimit;
  switch (limit) {
    case kDevice:
      return "largest stable stiffness of the device";
    case kRequested:
      return "stiffness of the scene's contact and effects";
    case kLever:
      return "rotational stiffness of the virtual tool (tool.lever_m)";
    case kLoop:
      return "stability of the loop (voxtouch design)";
    case kSetByHand:
      return "the scene's own coupling values";
  }
  return "unknown";
}

}  // namespace

std::string contact_line(const device_fit::ForcePreview& p, const std::string& device) {
  std::string text;
  if (const double across = p.across_n_per_m();
      p.reach_m > 0.0 && across < kAlmost * p.stiffness_n_per_m)
    text = fmt::format(
        "At the tool's reach of {:.3g} mm, {} displays {:.4g} N/m along the lever arm and {:.4g} "
        "N/m across it (the tool rotates).",
        1e3 * p.reach_m, device, p.stiffness_n_per_m, across);
  if (p.grip_n_per_m > 0.0)
    text += fmt::format(
        "{}The body effect's grip stiffness of {:.4g} N/m is limited to the certified {:.4g} N/m.",
        text.empty() ? "" : " ", p.grip_n_per_m, p.stiffness_n_per_m);
  return text;
}

std::vector<std::string> force_lines(const device_fit::ForcePreview& p, const std::string& device) {
  std::vector<std::string> lines{fmt::format(
      "Certified: {:.4g} N/m, gain margin {:.3g}. {} saturates at {:.3g} N, {:.3g} mm deep. "
      "Limited by: {}.",
      p.stiffness_n_per_m, p.gain_margin, device, p.force_n, 1e3 * p.depth_m, words_for(p.limit))};
  if (std::string contact = contact_line(p, device); !contact.empty())
    lines.push_back(std::move(contact));
  return lines;
}

}  // namespace voxtouch::cli

#include "core/rendering/reload_check.hpp"

#include <algorithm>
#include <tuple>

namespace voxtouch {
namespace {

// A member that is added must be compared below; the sizes tell.
static_assert(sizeof(CouplingSpec) == sizeof(std::string) + 12 * sizeof(double));
static_assert(sizeof(HandRange) == 7 * sizeof(double));

bool same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

bool same(const WorkspaceMapping& a, const WorkspaceMapping& b) {
  return a.position_scale == b.position_scale && a.force_scale == b.force_scale &&
         same(a.device_in_world, b.device_in_world) && same(a.tool_offset, b.tool_offset) &&
         a.clutch_button == b.clutch_button;
}

auto members(const CouplingSpec& c) {
  return std::tie(c.kind, c.cutoff_hz, c.damping_ratio, c.gain, c.stiffness_n_per_m, c.damping_ns_per_m,
                  c.stiffness_cap_n_per_m, c.stiffness_cap_nm_per_rad, c.injected_damping_ns_per_m,
                  c.injected_damping_nms_per_rad, c.velocity_filter_hz, c.passivity_damping_limit_ns_per_m,
                  c.passivity_damping_limit_nms_per_rad);
}

auto members(const HandRange& h) {
  return std::tie(h.any_passive, h.may_release, h.mass_min, h.mass_max, h.damping_min, h.damping_max, h.stiffness_min,
                  h.stiffness_max);
}

bool same(const DesignOptions& a, const DesignOptions& b) {
  const auto plain = [](const DesignOptions& d) {
    return std::tie(d.kind, d.cutoff_hz, d.gain_margin, d.stiffness_cap_n_per_m, d.stiffness_cap_nm_per_rad, d.hand,
                    d.released, d.inject_damping, d.run_infeasible);
  };
  return plain(a) == plain(b) && members(a.given_translation) == members(b.given_translation) &&
         a.given_rotation.has_value() == b.given_rotation.has_value() &&
         (!a.given_rotation || members(*a.given_rotation) == members(*b.given_rotation));
}

bool same(const Region& a, const Region& b) {
  if (a.shape.index() != b.shape.index() || a.blend_m != b.blend_m) return false;
  if (const auto* sphere = std::get_if<SphereRegion>(&a.shape)) {
    const auto& other = std::get<SphereRegion>(b.shape);
    return sphere->centre == other.centre && sphere->radius_m == other.radius_m;
  }
  if (const auto* box = std::get_if<BoxRegion>(&a.shape)) {
    const auto& other = std::get<BoxRegion>(b.shape);
    return same(box->pose, other.pose) && box->size_m == other.size_m;
  }
  return true;
}

bool same(const EffectSpec& a, const EffectSpec& b) {
  return a.name == b.name && a.kind == b.kind && a.values == b.values && a.gain == b.gain && a.on == b.on &&
         a.object == b.object && same(a.region, b.region);
}

}  // namespace

std::string why_not_reloaded(const Scene& running, const Scene& next) {
  if (!same(running.device, next.device))
    return "the scene's 'device' section has changed, which the device and coupling nodes do not read again: restart "
           "the "
           "ring for it";
  const bool designed = running.design.has_value();
  if (designed != next.design.has_value() || (designed && !same(*running.design, *next.design)) ||
      members(running.coupling) != members(next.coupling))
    return "the scene's 'coupling' section has changed, which the coupling node does not read again: restart the ring "
           "for it";
  if (needs_of(running.effects).body || needs_of(next.effects).body)
    return "the scene's dynamic object is a body that lies somewhere by itself, and a scene built anew would not know where: "
           "restart the ring for it";
  return {};
}

std::vector<EffectSpec> carried_over(std::span<const EffectSpec> before, std::span<const EffectSpec> now,
                                     std::span<const EffectSpec> next) {
  std::vector<EffectSpec> effects(next.begin(), next.end());
  for (EffectSpec& effect : effects) {
    const auto old = std::find_if(before.begin(), before.end(), [&](const EffectSpec& e) { return same(e, effect); });
    if (old != before.end()) effect = now[static_cast<std::size_t>(old - before.begin())];
  }
  return effects;
}

}  // namespace voxtouch

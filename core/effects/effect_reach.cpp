#include "core/effects/effect_reach.hpp"

#include <algorithm>

namespace voxtouch::effects {
namespace {

EffectBound larger(const EffectBound& a, const EffectBound& b) {
  return {.stiffness_n_per_m = std::max(a.stiffness_n_per_m, b.stiffness_n_per_m),
          .stiffness_nm_per_rad = std::max(a.stiffness_nm_per_rad, b.stiffness_nm_per_rad),
          .damping_ns_per_m = std::max(a.damping_ns_per_m, b.damping_ns_per_m),
          .damping_nms_per_rad = std::max(a.damping_nms_per_rad, b.damping_nms_per_rad),
          .force_n = std::max(a.force_n, b.force_n),
          .potential_j = std::max(a.potential_j, b.potential_j),
          .energy_per_metre_j = std::max(a.energy_per_metre_j, b.energy_per_metre_j),
          .external_force_n = std::max(a.external_force_n, b.external_force_n),
          .external_torque_nm = std::max(a.external_torque_nm, b.external_torque_nm)};
}

}  // namespace

std::vector<EffectReach> at_rest(std::span<const EffectSpec> effects) {
  return {effects.begin(), effects.end()};
}

void EffectReach::widen(const EffectSpec& to) { widen(EffectReach(to)); }

void EffectReach::widen(const EffectReach& to) {
  for (std::size_t p = 0; p < low_.size(); ++p) {
    low_.at(p)[0] = std::min(low_.at(p)[0], to.low_.at(p)[0]);
    high_.at(p)[0] = std::max(high_.at(p)[0], to.high_.at(p)[0]);
  }
  spec_ = to.spec_;
}

EffectBound EffectReach::bound() const {
  std::vector<std::size_t> moving;
  for (std::size_t p = 0; p < spec_.values.size(); ++p)
    if (spec_.kind->parameters[p].shape == ParameterShape::kNumber &&
        low_.number(p) < high_.number(p))
      moving.push_back(p);
  EffectSpec at = spec_;
  EffectBound most = bound_of(at);
  for (std::size_t corner = 0; !moving.empty() && corner < std::size_t{1} << moving.size();
       ++corner) {
    for (std::size_t n = 0; n < moving.size(); ++n)
      at.values.at(moving[n])[0] = (corner >> n & 1U ? high_ : low_).number(moving[n]);
    most = larger(most, bound_of(at));
  }
  return most;
}

}  // namespace voxtouch::effects

#include "core/effects/effect_chain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace voxtouch::effects {
namespace {

bool usable(const EffectForce& force) noexcept {
  return force.wrench.finite() && force.stiffness.allFinite() &&
         std::isfinite(force.stiffness_bound_n_per_m) && std::isfinite(force.potential_j) &&
         std::isfinite(force.energy_generated_j);
}

/// The same frame with the contact of one object only.
EffectFrame narrowed(const EffectFrame& frame, std::uint32_t object) noexcept {
  EffectFrame one = frame;
  one.contacts = {};
  for (const ObjectContact& contact : frame.contacts)
    if (contact.object == object)
      one.contacts = {&contact, 1};
  return one;
}

/// Whether the effect is memoryless and independent of the contact.
bool is_of_position(const EffectSpec& spec, const EffectValues& now) noexcept {
  return spec.kind->energy == EnergyBehaviour::kConservative && !spec.kind->needs(now).contact;
}

}  // namespace

EffectChain::EffectChain(std::vector<EffectSpec> effects) {
  links_.reserve(effects.size());
  for (EffectSpec& spec : effects) {
    if (const std::string why = check_values(*spec.kind, spec.values); !why.empty())
      throw std::invalid_argument(fmt::format("effect '{}': {}", spec.name, why));
    per_metre_j_ += bound_of(spec).energy_per_metre_j;
    Link link;
    link.now = link.rate = spec.values;
    link.gain = coupling::Ramp(spec.on ? spec.gain : 0.0);
    link.effect = spec.kind->make();
    link.goal = std::move(spec);
    links_.push_back(std::move(link));
  }
}

void EffectChain::advance(Link& link, double dt_s) noexcept {
  link.gain.advance(dt_s);
  for (std::size_t p = 0; p < link.now.size(); ++p) {
    const std::array<double, 3>& goal = link.goal.values.at(p);
    std::array<double, 3>& now = link.now.at(p);
    if (now == goal)
      continue;
    for (std::size_t n = 0; n < 3; ++n) {
      const double step = link.rate.at(p)[n] * dt_s;
      now[n] = std::clamp(goal[n], now[n] - step, now[n] + step);
    }
  }
}

void EffectChain::weigh(const Link& link, const RegionWeight& weight, const EffectForce& own,
                        EffectForce& sum) noexcept {
  const bool inside = link.goal.kind->scales_inside;
  const double gain = link.gain.now(), fraction = inside ? 1.0 : gain * weight.weight;
  sum.wrench.force += fraction * own.wrench.force;
  sum.wrench.torque += fraction * own.wrench.torque;
  sum.stiffness += fraction * own.stiffness;
  sum.stiffness_bound_n_per_m += fraction * own.stiffness_bound_n_per_m;
  sum.energy_generated_j += own.energy_generated_j;
  if (weight.gradient.isZero(0.0)) {
    sum.potential_j += fraction * own.potential_j;
    return;
  }
  const Region& region = link.goal.region;
  // A limit scaled by the weight moves like a force of full weight.
  const double slope = weight.gradient.norm();
  const double force =
      inside ? own.wrench.force.norm() / (gain * weight.weight) : own.wrench.force.norm();
  double added = gain * slope * force;
  if (link.goal.kind->energy == EnergyBehaviour::kConservative) {
    sum.wrench.force -= (gain * own.potential_j) * weight.gradient;
    sum.potential_j += fraction * own.potential_j;
    added =
        gain * (2.0 * slope * force + curvature_bound_per_m2(region) * std::abs(own.potential_j));
  }
  sum.stiffness.topLeftCorner<3, 3>().diagonal().array() += added;
  sum.stiffness_bound_n_per_m += added;
}

double EffectChain::friction_at(const Vec3& x, std::uint32_t object) const noexcept {
  double sum = 0.0;
  for (const Link& link : links_)
    if (link.goal.kind->friction != nullptr && link.goal.object.value_or(object) == object)
      sum += link.gain.now() * weight_at(link.goal.region, x).weight *
             link.goal.kind->friction(link.now);
  return sum;
}

EffectForce EffectChain::of_position(const EffectFrame& frame) const noexcept {
  EffectForce sum;
  for (const Link& link : links_) {
    if (!(link.gain.now() > 0.0) || !is_of_position(link.goal, link.now))
      continue;
    const RegionWeight weight = weight_at(link.goal.region, frame.tool.position);
    if (weight.weight <= 0.0 && weight.gradient.isZero(0.0))
      continue;
    EffectForce own, with = sum;
    EffectFrame scaled = frame;
    scaled.fraction = link.gain.now() * weight.weight;
    link.effect->apply(scaled, link.now, own);
    weigh(link, weight, own, with);
    if (usable(with))
      sum = with;
  }
  return sum;
}

EffectForce EffectChain::apply(const EffectFrame& at_hand, const EffectFrame* surface,
                               const EffectFrame* softened) noexcept {
  EffectForce sum;
  for (Link& link : links_) {
    advance(link, at_hand.dt_s);
    if (surface != nullptr && link.goal.kind->friction != nullptr)
      continue;
    const bool depends_on_contact = surface != nullptr && link.goal.kind->needs(link.now).contact;
    const bool behind_spring = softened != nullptr && is_of_position(link.goal, link.now);
    const EffectFrame& frame = behind_spring ? *softened : depends_on_contact ? *surface : at_hand;
    const RegionWeight weight = link.gain.now() > 0.0
                                    ? weight_at(link.goal.region, frame.tool.position)
                                    : RegionWeight{0.0};
    if (weight.weight <= 0.0 && (link.goal.kind->scales_inside || weight.gradient.isZero(0.0))) {
      link.effect->reset();  // its state must exert no force when the effect returns
      continue;
    }
    EffectForce own;
    EffectFrame scaled = link.goal.object ? narrowed(frame, *link.goal.object) : frame;
    scaled.fraction = link.gain.now() * weight.weight;
    link.effect->apply(scaled, link.now, own);
    EffectForce with = sum;
    weigh(link, weight, own, with);
    if (usable(with)) {
      sum = with;
    } else {
      ++not_finite_;
      link.effect->reset();
    }
  }
  return sum;
}

bool EffectChain::at_rest() const noexcept {
  // An unused number may be NaN, which counts as unchanged.
  const auto moves = [](double now, double goal) {
    return now != goal && !(std::isnan(now) && std::isnan(goal));
  };
  for (const Link& link : links_)
    for (std::size_t p = 0; p < link.now.size(); ++p)
      for (std::size_t n = 0; n < 3; ++n)
        if (moves(link.now.at(p)[n], link.goal.values.at(p)[n]))
          return false;
  return true;
}

void EffectChain::reset() noexcept {
  for (Link& link : links_)
    link.effect->reset();
}

void EffectChain::carry_out(const EffectCommand& command) noexcept {
  Link& link = links_[command.effect];
  voxtouch::effects::carry_out(link.goal, command);
  if (command.action != EffectAction::kValue) {
    link.gain.head_for(link.goal.on ? link.goal.gain : 0.0, kEffectRampS);
    return;
  }
  const std::array<double, 3>&now = link.now.at(command.parameter), &goal = command.value;
  for (std::size_t n = 0; n < 3; ++n)
    link.rate.at(command.parameter)[n] = std::abs(goal[n] - now[n]) / kEffectRampS;
}

}  // namespace voxtouch::effects

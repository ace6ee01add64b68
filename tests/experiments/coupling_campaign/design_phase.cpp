#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/design/designer.hpp"
#include "nodes/design_text/design_text.hpp"
#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {
namespace {

using Law = coupling::design::LoopController::Law;

coupling::design::LoopController controller_of(const coupling::CouplingSpec& spec) {
  coupling::design::LoopController out;
  out.injected_damping = spec.injected_damping_ns_per_m;
  out.use(coupling::design::velocity_of(spec));
  if (spec.kind == "shaping_filter") {
    out.w0_rad_per_s = coupling::cutoff_rad_per_s(spec), out.damping_ratio = spec.damping_ratio,
    out.gain = spec.gain;
  } else if (spec.kind == "spring_damper") {
    out.law = Law::kSpringDamper;
    out.stiffness = spec.stiffness_n_per_m, out.damping = spec.damping_ns_per_m;
  } else {
    out.law = Law::kDirect;
  }
  return out;
}

coupling::design::DesignProblem request_for(const coupling_models::PopulationMember& member,
                                            std::optional<double> damping_force_ratio,
                                            coupling_models::Random& random) {
  coupling::design::DesignProblem out;
  out.goals.damping_force_ratio = damping_force_ratio;
  out.device = member.device;
  out.hand.translation = member.hand;
  out.contact = member.contact;
  const unsigned kind = random.below(4);
  out.goals.kind = kind == 0 ? "shaping_filter" : "auto";
  out.goals.cutoff_hz = random.chance(0.7) ? 5.0 : random.log_uniform(1.0, 50.0);
  out.goals.cutoff_hz =
      std::min(out.goals.cutoff_hz, 0.5 / (2.0 * std::numbers::pi * member.device.timing.period_s));
  out.goals.allow_injected_damping = random.chance(0.8);
  out.goals.free_cap = random.chance(0.3);
  out.goals.velocity_windows = random.chance(0.5);
  if (random.chance(0.5))
    out.goals.min_damping = {0.0, 0.0};
  return out;
}

/// A design and the loops that it is tried in.
struct Tried {
  const coupling_models::PopulationMember& member;
  const coupling::design::Design& design;
  coupling::design::LoopController controller;
  double contact;  ///< all points, capped by the design

  coupling_models::NonlinearLoop loop(const coupling::design::LoopPlant& plant) const {
    coupling_models::NonlinearLoop out;
    out.plant = plant;
    out.controller = controller;
    out.contact_stiffness = contact;
    out.damping_only_in_contact = true, out.damping_fraction = design.spec.damping_force_ratio,
    out.damping_free = design.spec.damping_force_offset_n;
    out.slow_velocity_rad_per_s = 2.0 * std::numbers::pi * design.spec.slow_velocity_hz,
    out.velocity_band = design.spec.velocity_band_m_per_s;
    return out;
  }
  /// The worst vertex, at the nominal timing and not at the slowest one, at which its promise
  /// holds.
  coupling::design::LoopPlant worst() const {
    coupling::design::LoopPlant out = design.translation.worst_case.plant;
    out.period_s = member.device.timing.period_s, out.delay_s = member.device.timing.delay_s;
    return out;
  }
};

struct Setting {
  const char* name;
  coupling_models::NonlinearLoop loop;
};

std::vector<Setting> settings_of(const Tried& t, coupling_models::Random& random) {
  const coupling::design::AxisModel& axis = t.member.device.translation;
  const double displayed = t.design.translation.displayed_stiffness,
               period = t.member.device.timing.period_s;
  std::vector<Setting> out;
  const auto add = [&](const char* name, const coupling::design::LoopPlant& plant, auto change) {
    Setting setting{name, t.loop(plant)};
    disturb(setting.loop, t.member.device.timing, axis.resolution, random);
    change(setting.loop);
    drive(setting.loop, displayed, axis.max_effort, random);
    out.push_back(setting);
  };
  add("any hand, mass and wall", coupling_models::draw_plant(t.member, random),
      [&](coupling_models::NonlinearLoop& loop) {
        loop.delay_jitter_s = random.uniform(0.0, 0.2) * period;
        if (random.chance(0.5))
          loop.coulomb_friction = axis.coulomb_friction;
      });
  add("worst vertex, up to a period of delay more", t.worst(),
      [&](coupling_models::NonlinearLoop& loop) {
        loop.plant.delay_s += random.uniform(0.0, 0.8) * period;
        loop.delay_jitter_s = 0.2 * period;
      });
  add("with saturation", coupling_models::draw_plant(t.member, random),
      [&](coupling_models::NonlinearLoop&) {});
  // Not below the noise that the damping may make of the encoder's steps: a device that gives no
  // more has nothing to damp with.
  out.back().loop.max_effort =
      std::min(axis.max_effort, std::max(out.back().loop.push * random.uniform(1.2, 3.0),
                                         t.design.spec.damping_force_offset_n));
  if (t.controller.law == Law::kSpringDamper)
    return out;  // its promise does not grow with the contact
  for (const auto& [name, times] : {std::pair{"1.9 times the promise at the slowest timing", 1.9},
                                    {"1.4 times the promise at the slowest timing", 1.4}})
    add(name, t.design.translation.worst_case.plant, [&](coupling_models::NonlinearLoop& loop) {
      loop.contact_stiffness *= times;
      loop.jitter = loop.loss = 0.0;
      loop.measured_period = false;
    });
  return out;
}

/// Simulated limit divided by the certified stiffness with `plant`: uniform timing, a unilateral
/// wall.
double limit_over_promise(const Tried& t, const coupling::design::LoopPlant& plant,
                          coupling_models::Random random) {
  coupling_models::NonlinearLoop loop = t.loop(plant);
  drive(loop, t.design.translation.displayed_stiffness, t.member.device.translation.max_effort,
        random);
  loop.longest_s = 4.0 * loop.duration_s;
  return coupling_models::simulated_limit(loop, t.contact, 64.0 * t.contact) / t.contact;
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty())
    return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5)];
}

class Phase {
 public:
  explicit Phase(const Options& options) : options_(options) {}

  void member(const coupling_models::PopulationMember& member, std::uint64_t salt, bool corner) {
    coupling_models::Random random(options_.seed ^ salt, member.index);
    const coupling::design::DesignProblem request =
        request_for(member, options_.damping_force_ratio, random);
    const coupling::design::Design design = coupling::design::design_coupling(request);
    ++statuses_[static_cast<std::size_t>(design.status)];
    if (!member.hand.any_passive && design.status != coupling::design::DesignStatus::kInfeasible) {
      const bool min_damping = request.goals.min_damping.gripped > 0.0;
      if (member.hand.may_release)
        swings_[min_damping][0].push_back(design.swing.released.ratio);
      swings_[min_damping][1].push_back(design.swing.gripped.ratio);
    }
    const coupling::design::AxisDesign& axis = design.translation;
    // Infeasible designs are simulated too, unless nothing is certified.
    if (!(axis.displayed_stiffness > 0.0 &&
          axis.gain_margin >= 0.999 * request.goals.gain_margin)) {
      ++nothing_promised_;
      return;
    }
    const Tried tried{
        member, design, controller_of(design.spec),
        options_.overload * std::min(member.contact.all_points, design.spec.stiffness_cap_n_per_m)};
    for (const Setting& setting : settings_of(tried, random)) {
      const coupling_models::NonlinearVerdict verdict = coupling_models::simulate(setting.loop);
      if (out_.count(setting.name, verdict))
        out_.failures.push_back(
            {setting.name, options_.seed, member.index, corner,
             fmt::format("{}; margin {:.4g}, worst {}; {}",
                         coupling::design::name_of(design.status), axis.gain_margin,
                         design_text::worst_case_of(design, 0), describe(setting.loop, verdict))});
    }
    if (!corner && design.status != coupling::design::DesignStatus::kInfeasible &&
        tried.controller.law != Law::kSpringDamper && slowest_.size() < options_.limits) {
      slowest_.push_back(limit_over_promise(tried, design.translation.worst_case.plant, random));
      nominal_.push_back(limit_over_promise(tried, tried.worst(), random));
    }
  }

  PhaseResult result() {
    for (const coupling::design::DesignStatus s :
         {coupling::design::DesignStatus::kAsRequested,
          coupling::design::DesignStatus::kBandwidthRaised,
          coupling::design::DesignStatus::kDampingAdded,
          coupling::design::DesignStatus::kStiffnessReduced,
          coupling::design::DesignStatus::kInfeasible})
      out_.figures.push_back({std::string(coupling::design::name_of(s)),
                              static_cast<double>(statuses_[static_cast<std::size_t>(s)])});
    out_.figures.push_back({"nothing promised, not run", static_cast<double>(nothing_promised_)});
    out_.figures.push_back(
        {"promises compared with the simulated limit", static_cast<double>(slowest_.size())});
    for (const auto& [timing, limits] : {std::pair{"slowest", &slowest_}, {"nominal", &nominal_}})
      for (const auto& [name, fraction] :
           {std::pair{"least", 0.0}, {"5 %", 0.05}, {"median", 0.5}, {"95 %", 0.95}})
        out_.figures.push_back({fmt::format("limit / promise, {} timing, {}", timing, name),
                                quantile(*limits, fraction)});
    for (const bool min_damping : {false, true})
      for (const bool gripped : {false, true})
        for (const auto& [name, fraction] :
             {std::pair{"least", 0.0}, {"5 %", 0.05}, {"median", 0.5}})
          out_.figures.push_back({fmt::format("damping ratio, {}, {}, {}",
                                              min_damping ? "minimum requested" : "no minimum",
                                              gripped ? "gripped" : "released", name),
                                  quantile(swings_[min_damping][gripped], fraction)});
    return std::move(out_);
  }

 private:
  const Options& options_;
  PhaseResult out_{.name = "designs", .tallies = {}, .figures = {}, .failures = {}};
  std::array<std::uint64_t, 5> statuses_{};
  std::uint64_t nothing_promised_ = 0;
  std::array<std::array<std::vector<double>, 2>, 2>
      swings_;  ///< damping ratio of the dominant mode: [requested minima][gripped]
  std::vector<double> slowest_, nominal_;  ///< limit over promise, at the timing that the promise
                                           ///< is for and without jitter and losses
};

}  // namespace

PhaseResult design_phase(const Options& options) {
  Phase phase(options);
  const std::uint64_t corners = options.corners ? 256 : 0, all = options.members + corners;
  std::uint64_t done = 0;
  const auto print = [&] {
    if (options.progress)
      options.progress(++done, all);
  };
  for (std::uint64_t i = 0; i < options.members; ++i) {
    phase.member(coupling_models::draw_member(options.seed, options.first + i), 0xde5160, false);
    print();
  }
  if (!options.corners)
    return phase.result();
  for (const coupling_models::DeviceFamily family :
       {coupling_models::DeviceFamily::kPhantomLike, coupling_models::DeviceFamily::kLwrLike})
    for (const coupling_models::PopulationMember& member :
         coupling_models::corner_members(family)) {
      phase.member(member, family == coupling_models::DeviceFamily::kPhantomLike ? 0xc0a1 : 0xc0a2,
                   true);
      print();
    }
  return phase.result();
}

}  // namespace voxtouch::campaign

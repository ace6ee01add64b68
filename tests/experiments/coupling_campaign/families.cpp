/// stability_families: designed loops of random devices on walls, by family of contact; counts and
/// amplitudes of oscillations, with the run. `--family corner --only 17 --seed 1` repeats one run.
/// A run lasts until its last third is at rest, for 40 s at most. Exit status 1 if a run oscillates
/// by 0.2 N or more.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/coupling/design/design_axis.hpp"
#include "core/scene/device_file.hpp"
#include "devices/operator/hand.hpp"
#include "tests/support/coupling_models/random.hpp"
#include "tests/support/loop_rig/wall_loop.hpp"

namespace voxtouch::families {
namespace {

using coupling_models::Random;
using long_runs::LoopWall;
using long_runs::WallLoop;
using long_runs::WallLoopOptions;

/// In the last three the hand keeps moving: in and out of contact, with tremor, over textures. None
/// counts as an oscillation.
constexpr std::array kFamilies{"one_wall", "gentle", "blow",   "slot_tight", "slot_clear",
                               "corner",   "lever",  "timing", "cycle_wall", "cycle_slot",
                               "strokes",  "tremor", "texture"};
constexpr double kShortestS = 5.0, kLongestS = 40.0;    ///< of a run
constexpr double kSwingN = 0.2, kBounceN = 0.01;        ///< from peak to peak
constexpr std::array kTimes{1.25, 1.5, 2.0, 3.0, 4.0};  ///< of the promise, for margins

DeviceDescription draw_device(Random& random) {
  DeviceDescription d;
  d.model = "random";
  const bool pen = random.chance(0.5);
  d.grip = pen ? "pen" : "arm";
  d.rate_hz = random.log_uniform(500.0, 4000.0);
  d.mass_min_kg = pen ? random.log_uniform(0.03, 0.5) : random.log_uniform(0.5, 15.0);
  d.mass_max_kg = d.mass_min_kg * random.uniform(1.0, 1.6);
  d.damping_ns_per_m = random.chance(0.2) ? 0.0 : random.log_uniform(0.002, 5.0);
  d.coulomb_friction_n = random.chance(0.4) ? 0.0 : random.log_uniform(0.01, pen ? 0.3 : 2.0);
  d.position_resolution_m = random.log_uniform(5e-7, 1e-4);
  d.delay_s = std::min(random.log_uniform(1e-4, 5e-3), 8.0 / d.rate_hz);
  d.force_bandwidth_hz = random.chance(0.5) ? std::numeric_limits<double>::infinity()
                                            : random.log_uniform(30.0, 300.0);
  d.max_force_n = pen ? random.log_uniform(3.0, 30.0) : random.log_uniform(20.0, 150.0);
  d.max_stiffness_n_per_m = random.log_uniform(500.0, 8000.0);
  d.jitter = 0.2, d.consecutive_losses = random.chance(0.5) ? 1 : 0;
  if (random.chance(0.3)) {
    d.output_dof = 6;
    d.max_torque_nm = 0.05 * d.max_force_n;
    d.inertia_min_kg_m2 = d.mass_min_kg * 0.02, d.inertia_max_kg_m2 = d.inertia_min_kg_m2 * 1.5;
    d.damping_nms_per_rad = 0.01 * d.damping_ns_per_m + 1e-4,
    d.coulomb_friction_nm = 0.01 * d.coulomb_friction_n;
    d.orientation_resolution_rad = random.log_uniform(1e-5, 1e-3);
    d.max_stiffness_nm_per_rad = 0.01 * d.max_stiffness_n_per_m;
  }
  d.simulated = true;
  derive_slew_limits(d);
  return d;
}

struct Choice {
  std::uint64_t seed = 1, index = 0;
  std::size_t family = 0;
  std::string device;    ///< a file; empty: a random device
  double times = 1.0;    ///< the spring's stiffness over the promise
  double damping = 0.0;  ///< ratio that the simulated device has more than it was designed for
};

struct Result {
  bool feasible = false, swings = false, bounces = false, flagged = false, grew = false;
  double motion_m = 0.0, force_n = 0.0, largest_n = 0.0, promise_n_per_m = 0.0, lookups = 0.0,
         length_s = 0.0;
  double energy_ratio = -1.0;  ///< energy given in a closed cycle over 2 F A
  std::uint64_t slewed = 0;
  DeviceDescription device;
  coupling::CouplingSpec spec;
  double mass_kg = 0.0;
  bool direct = false, virtual_tool = false, released = false;
};

/// Least and largest of position and force, a tenth of a second at a time.
class Extremes {
 public:
  void add(double time_s, const Vec3& at_m, const Vec3& force_n) {
    const auto part = static_cast<std::size_t>(10.0 * time_s);
    if (part >= parts_.size())
      parts_.resize(part + 1);
    parts_[part].add(at_m, force_n);
  }
  /// Peak to peak of the motion and of the force in the last third.
  std::pair<double, double> last_third() const {
    Part all;
    for (std::size_t n = parts_.size() - parts_.size() / 3; n < parts_.size(); ++n) {
      all.add(parts_[n].low_m, parts_[n].low_n);
      all.add(parts_[n].high_m, parts_[n].high_n);
    }
    return {(all.high_m - all.low_m).norm(), (all.high_n - all.low_n).norm()};
  }

 private:
  struct Part {
    Vec3 low_m = Vec3::Constant(1e9), high_m = -low_m, low_n = low_m, high_n = -low_m;
    void add(const Vec3& at_m, const Vec3& force_n) {
      low_m = low_m.cwiseMin(at_m), high_m = high_m.cwiseMax(at_m);
      low_n = low_n.cwiseMin(force_n), high_n = high_n.cwiseMax(force_n);
    }
  };
  std::vector<Part> parts_;
};

/// Energy that the hand receives in a cycle of 2 s, the mean of two, over 2 F A: the work of the
/// force less what the device itself takes.
class ClosedCycles {
 public:
  static constexpr double kFromS = 6.0, kUntilS = 10.0, kCycles = 2.0;
  explicit ClosedCycles(const DeviceDescription& device) : device_(device) {}
  void add(double time_s, const Vec3& at_m, const Vec3& applied_n) {
    if (time_s >= kFromS && time_s < kUntilS) {
      const Vec3 moved = at_m - last_m_;
      given_j_ += 0.5 * (applied_n + last_n_).dot(moved) -
                  device_.damping_ns_per_m * moved.squaredNorm() * device_.rate_hz -
                  device_.coulomb_friction_n * moved.norm();
      largest_n_ = std::max(largest_n_, applied_n.norm());
      low_m_ = low_m_.cwiseMin(at_m), high_m_ = high_m_.cwiseMax(at_m);
    }
    last_m_ = at_m, last_n_ = applied_n;
  }
  /// Of a motion of at least 25 encoder steps; -1 below it, where the encoder decides.
  double fraction() const {
    const double path_m = (high_m_ - low_m_).norm();
    return path_m >= 25.0 * device_.position_resolution_m
               ? given_j_ / kCycles / (2.0 * largest_n_ * path_m)
               : -1.0;
  }

 private:
  DeviceDescription device_;
  double given_j_ = 0.0, largest_n_ = 1e-9;
  Vec3 last_m_ = Vec3::Zero(), last_n_ = Vec3::Zero(), low_m_ = Vec3::Constant(1e9),
       high_m_ = -low_m_;
};

bool hand_goes_on(const std::string& family) {
  return family == "strokes" || family == "tremor" || family == "texture" ||
         family.starts_with("cycle");
}

Vec3 turned_z(double angle) { return {std::sin(angle), 0.0, std::cos(angle)}; }

/// Walls, motion and other parts of the family.
void set_up(const std::string& family, Random& random, const coupling::design::Design& design,
            WallLoopOptions& o) {
  const double cap = design.translation.displayed_stiffness,
               rigid = cap * random.log_uniform(0.1, 1000.0);
  const double depth =
      std::min(random.log_uniform(1e-4, 5e-3), 0.4 * o.designed_for.max_force_n / cap);
  LoopWall wall{.normal = turned_z(random.chance(0.5) ? 0.0 : random.uniform(-0.6, 0.6)),
                .n_per_m = rigid};
  const double bend = random.unit();
  if (bend < 0.25)
    wall.knee_m = 0.3 * depth, wall.beyond = 0.3;
  if (bend > 0.75)
    wall.knee_m = 0.5 * depth, wall.beyond = 5.0;
  Motion& m = o.motion;
  m.hold_s = 0.3, m.speed_m_per_s = 0.05;
  m.path = {3e-3 * wall.normal, -depth * wall.normal};
  o.walls = {wall};
  if (family == "gentle") {
    o.designed_for.position_resolution_m = o.device.description.position_resolution_m =
        random.uniform(2e-5, 1e-4);
    o.designed_for.coulomb_friction_n = o.device.description.coulomb_friction_n = 0.0;
    m.speed_m_per_s = random.uniform(0.005, 0.05);
    m.path[1] = -random.uniform(1e-4, 1e-3) * wall.normal;
  } else if (family == "blow") {
    m.speed_m_per_s = random.log_uniform(0.1, 3.0);
    m.path = {0.08 * wall.normal, -depth * wall.normal};
  } else if (family == "slot_tight" || family == "slot_clear" || family == "cycle_slot") {
    const double gap =
        family != "slot_clear" ? -random.log_uniform(1e-4, 2e-3) : random.log_uniform(5e-5, 2e-3);
    o.walls = {{.normal = Vec3::UnitZ(), .at_m = -0.5 * gap, .n_per_m = rigid},
               {.normal = -Vec3::UnitZ(), .at_m = -0.5 * gap, .n_per_m = rigid}};
    m.path = {Vec3::Zero(),
              Vec3(0, 0, (random.chance(0.5) ? 1.0 : -1.0) * (depth + std::max(0.0, gap)))};
    if (family == "cycle_slot")
      m.path[0] = -m.path[1];
  } else if (family == "corner") {
    const double angle = random.uniform(40.0, 140.0) * std::numbers::pi / 180.0;
    const double lean = 0.5 * std::numbers::pi - 0.5 * angle;
    o.walls = {{.normal = turned_z(lean), .n_per_m = rigid},
               {.normal = turned_z(-lean),
                .n_per_m = random.chance(0.5) ? rigid : cap * random.log_uniform(0.1, 1000.0)}};
    m.path = {Vec3(0, 0, 3e-3), Vec3(0.3 * depth * random.uniform(-1.0, 1.0), 0, -depth)};
  } else if (family ==
             "strokes") {  // strokes in contact and out of it, with tremor: not an oscillation
    m.path = {-random.uniform(-1.0, 0.8) * depth * wall.normal, -depth * wall.normal};
    m.repeat_from = 0, m.hold_s = 0.0;
    m.speed_m_per_s = (m.path[0] - m.path[1]).norm() * random.log_uniform(1.0, 10.0);
    o.hand.tremor_n = random.chance(0.5) ? random.uniform(0.02, 0.3) : 0.0,
    o.hand.tremor_bandwidth_hz = random.uniform(8.0, 12.0);
  } else if (family == "tremor") {  // 8 to 12 Hz in contact; the hand's lags leave two fifths of it
    m.path = {-0.5 * depth * wall.normal, -(0.5 + random.uniform(0.3, 2.0)) * depth * wall.normal};
    m.repeat_from = 0, m.hold_s = 0.0;
    m.speed_m_per_s =
        kMinimumJerkPeak * (m.path[0] - m.path[1]).norm() * 2.0 * random.uniform(8.0, 12.0);
  } else if (family == "texture") {
    const Vec3 along(wall.normal.z(), 0, -wall.normal.x());
    const double half_m = random.uniform(5e-3, 20e-3);
    m.path = {-depth * wall.normal - half_m * along, -depth * wall.normal + half_m * along};
    m.repeat_from = 0, m.hold_s = random.uniform(0.0, 0.3),
    m.speed_m_per_s = random.log_uniform(0.005, 0.2);
    o.walls[0].texture_m = depth * random.uniform(0.05, 0.5);
    o.walls[0].texture_per_m = 2.0 * std::numbers::pi / random.log_uniform(5e-4, 5e-3);
  } else if (family == "lever") {
    o.walls[0].arm = Vec3(random.uniform(0.08, 0.15), 0, 0);
  }
  if (family.starts_with("cycle")) {  // well above the encoder's steps, which hide energy
    const double least_m = 25.0 * o.designed_for.position_resolution_m,
                 half_m = 0.5 * (m.path[0] - m.path[1]).norm();
    if (half_m < least_m)
      m.path[0] *= least_m / half_m, m.path[1] *= least_m / half_m;
    m.repeat_from = 0, m.hold_s = 0.0;
    m.speed_m_per_s = kMinimumJerkPeak * (m.path[0] - m.path[1]).norm();  // there and back in 2 s
  }
  if (hand_goes_on(family))
    o.hand.release_time_s = std::numeric_limits<double>::infinity();
}

/// Runs on until it is at rest, for its slowest motion may take long to decay.
void simulate(WallLoop& loop, const WallLoopOptions& o, const std::string& family, Result& r) {
  const double rate = o.device.description.rate_hz,
               still_m = 3.0 * o.designed_for.position_resolution_m;
  const bool goes_on = hand_goes_on(family), cycle = family.starts_with("cycle");
  Extremes extremes;
  ClosedCycles cycles(o.device.description);
  std::size_t n = 0;
  for (double until_s = cycle ? ClosedCycles::kUntilS : kShortestS; until_s <= kLongestS;
       until_s *= 2.0) {
    for (; static_cast<double>(n) < until_s * rate; ++n) {
      const Vec3 given = loop.step().force, at = loop.device().plant().pose().position;
      r.lookups += loop.spring().lookups();
      r.largest_n = std::max(r.largest_n, given.norm());
      extremes.add(static_cast<double>(n) / rate, at, given);
      if (cycle)
        cycles.add(static_cast<double>(n) / rate, at, loop.device().applied().force);
    }
    r.length_s = until_s;
    std::tie(r.motion_m, r.force_n) = extremes.last_third();
    if (goes_on || r.motion_m <= still_m || r.force_n <= kBounceN)
      break;
  }
  r.lookups /= static_cast<double>(n);
  if (cycle)
    r.energy_ratio = cycles.fraction();
  const bool moves = !goes_on && r.motion_m > still_m;
  r.swings = moves && r.force_n >= kSwingN;
  r.bounces = moves && !r.swings && r.force_n > kBounceN;
}

Result run(const Choice& choice) {
  Random random(choice.seed, 1000 * choice.index + choice.family);
  const std::string name = kFamilies[choice.family];
  WallLoopOptions o;
  o.designed_for = draw_device(random);
  if (!choice.device.empty()) {
    o.designed_for = scene::load_device_file(choice.device).description;
    o.designed_for.simulated = true;
  }
  o.kind = random.chance(0.5) ? "direct" : "shaping_filter";
  o.times_promise = choice.times;
  o.virtual_tool = random.chance(0.3);
  o.seed = choice.index;
  if (name == "gentle")
    o.designed_for.position_resolution_m = random.uniform(2e-5, 1e-4),
    o.designed_for.coulomb_friction_n = 0.0;
  Result r;
  coupling::design::Design design;
  try {
    design = long_runs::design_for(o.designed_for, o.kind);
  } catch (const std::invalid_argument&) {  // numbers that cannot be computed with
    return r;
  }
  if (design.status == coupling::design::DesignStatus::kInfeasible)
    return r;
  r.feasible = true, r.promise_n_per_m = design.translation.displayed_stiffness;
  r.spec = design.spec;
  o.device = sim::simulated(o.designed_for);
  o.device.mass_kg =
      Vec3::Constant(random.uniform(o.designed_for.mass_min_kg, o.designed_for.mass_max_kg));
  static constexpr std::array kPens{"pen", "pen-light", "pen-firm"},
      kArms{"arm", "arm-light", "arm-firm"};
  o.hand = *hand::grip((o.designed_for.grip == "pen" ? kPens : kArms)[random.below(3)]);
  const double arrives_s = 1.5;
  o.hand.release_time_s = random.chance(0.5) ? std::numeric_limits<double>::infinity()
                                             : arrives_s + random.uniform(0.0, 0.5);
  set_up(name, random, design, o);
  DeviceDescription& d = o.device.description;
  if (name == "timing") {
    o.device.mass_kg *= random.uniform(0.8, 1.2);
    d.delay_s *= random.uniform(0.8, 1.2);
    d.rate_hz /= random.uniform(1.0, 1.2);
    o.loss = 0.01, o.late = random.chance(0.5);
  }
  d.damping_ns_per_m += choice.damping * 2.0 * std::sqrt(o.device.mass_kg.x() * r.promise_n_per_m);
  r.device = o.designed_for, r.mass_kg = o.device.mass_kg.x();
  r.direct = o.kind == "direct", r.virtual_tool = o.virtual_tool;
  r.released = std::isfinite(o.hand.release_time_s);
  WallLoop loop(o, design);
  simulate(loop, o, name, r);
  const auto& swing = loop.counters().swing;
  r.flagged = swing.swings > 0, r.grew = loop.counters().growing;
  r.slewed = loop.guard().counts().clamped_slew;
  return r;
}

/// The damping ratio of the device from which a run comes to rest.
double damping_that_ends(Choice choice) {
  for (const double ratio : {0.01, 0.02, 0.05, 0.1, 0.2}) {
    choice.damping = ratio;
    const Result r = run(choice);
    if (!r.swings && !r.bounces)
      return ratio;
  }
  return 1.0;
}

struct Sum {
  std::uint64_t runs = 0, infeasible = 0, swings = 0, bounces = 0, flagged = 0, grew = 0,
                slewed = 0;
  double lookups = 0.0, most_n = 0.0, longest_s = 0.0, damping = 0.0, energy_ratio = -1.0;

  void take(const Result& r, const Choice& choice) {
    if (!r.feasible)
      return void(++infeasible);
    ++runs, swings += r.swings, bounces += r.bounces, flagged += r.flagged, grew += r.grew,
        slewed += r.slewed > 0;
    lookups += r.lookups;
    longest_s = std::max(longest_s, r.length_s),
    energy_ratio = std::max(energy_ratio, r.energy_ratio);
    if (!r.swings && !r.bounces)
      return;
    most_n = std::max(most_n, r.force_n);
    if (choice.times == 1.0)
      damping = std::max(damping, damping_that_ends(choice));
  }
  void print(const std::string& family) const {
    fmt::print(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {:.2f} N | {} | {:.4f} | {:.0f} s | {} |\n",
        family, runs, infeasible, swings, bounces, flagged, grew, slewed, most_n,
        damping > 0.0 ? fmt::format("{:g}", damping) : "",
        runs ? lookups / static_cast<double>(runs) : 0.0, longest_s,
        energy_ratio > -1.0 ? fmt::format("{:.2g}", energy_ratio) : "");
    std::fflush(stdout);
  }
};

void print_run(const Choice& c, const Result& r) {
  const std::string device = c.device.empty() ? "" : " --device " + c.device;
  const std::string times = c.times == 1.0 ? "" : fmt::format(" --times {}", c.times);
  fmt::print(stderr, "--family {} --only {} --seed {}{}{}: ", kFamilies[c.family], c.index, c.seed,
             device, times);
  if (!r.feasible)
    return fmt::print(stderr, "not feasible\n");
  fmt::print(stderr,
             "last third of {:.0f} s {:.3g} mm and {:.3g} N, {:.3g} N at most, promise {:.4g} N/m, "
             "given {:.2g}{}{}{}{}\n",
             r.length_s, 1e3 * r.motion_m, r.force_n, r.largest_n, r.promise_n_per_m,
             r.energy_ratio, r.swings ? ", swings" : "", r.flagged ? ", reported" : "",
             r.grew ? ", grew" : "", r.slewed ? ", slewed" : "");
  const DeviceDescription& d = r.device;
  fmt::print(stderr,
             "  {:.3g} kg, {:.3g} Ns/m, {:.3g} N dry, encoder {:.3g} mm, {:.0f} Hz, delay {:.2g} "
             "ms, lag {:.2g} ms; {}{}{}\n",
             r.mass_kg, d.damping_ns_per_m, d.coulomb_friction_n, 1e3 * d.position_resolution_m,
             d.rate_hz, 1e3 * d.delay_s, 1e3 / (2.0 * std::numbers::pi * d.force_bandwidth_hz),
             r.direct ? "direct" : fmt::format("filter of {:.3g} Hz", r.spec.cutoff_hz),
             r.virtual_tool ? ", rigid" : "", r.released ? ", released" : ", gripped");
  const int window = static_cast<int>(r.spec.velocity_window);
  const double speed =
      d.position_resolution_m * d.rate_hz *
      coupling::design::step_ratio(2.0 * std::numbers::pi * r.spec.velocity_filter_hz, window,
                                   1.0 / d.rate_hz);
  fmt::print(
      stderr,
      "  damping {:.3g} Ns/m on the velocity of {} (slow {:.3g} Hz), ratio {:.2g}; a step of "
      "the encoder is {:.2g} N of contact and {:.2g} N of damping\n",
      r.spec.injected_damping_ns_per_m,
      window > 0 ? fmt::format("a window of {}", window)
                 : fmt::format("{:.3g} Hz", r.spec.velocity_filter_hz),
      r.spec.slow_velocity_hz, r.spec.damping_force_ratio,
      r.promise_n_per_m * d.position_resolution_m, r.spec.injected_damping_ns_per_m * speed);
}

/// The largest tried factor over the promise at which a run does not swing; 1: it swings at the
/// first.
double margin(Choice choice) {
  double holds = 1.0;
  for (const double times : kTimes) {
    choice.times = times;
    if (run(choice).swings)
      return holds;
    holds = times;
  }
  return holds;
}

struct Request {
  std::uint64_t seed = 1, devices = 30;
  double times = 1.0;
  std::string family, device;
  std::vector<std::string> files;
  std::optional<std::uint64_t> only;
  bool every = false, margins = false;
};

/// Least and median margin of each family in which the hand comes to rest.
int margins(const Request& ask) {
  fmt::print(
      "| family | runs | least | median | swing at {:g} | the least |\n|---|---|---|---|---|---|\n",
      kTimes.back());
  for (std::size_t f = 0; f < kFamilies.size(); ++f) {
    if (hand_goes_on(kFamilies[f]) || (!ask.family.empty() && ask.family != kFamilies[f]))
      continue;
    std::vector<std::pair<double, std::uint64_t>> held;
    for (std::uint64_t n = 0; n < ask.devices; ++n) {
      const Choice choice{ask.seed, n, f, "", 1.0};
      if (run(choice).feasible)
        held.emplace_back(margin(choice), n);
    }
    if (held.empty())
      continue;
    std::ranges::sort(held);
    const auto swing =
        std::ranges::count_if(held, [](const auto& one) { return one.first < kTimes.back(); });
    fmt::print("| {} | {} | {:g} | {:g} | {} | `--only {} --seed {}` |\n", kFamilies[f],
               held.size(), held.front().first, held[held.size() / 2].first, swing,
               held.front().second, ask.seed);
    std::fflush(stdout);
  }
  return 0;
}

int all(const Request& ask) {
  fmt::print(
      "| family | runs | not feasible | swing by 0.2 N or more | smaller bounces | reported as a "
      "swing "
      "| grew | slew limit acted | largest bounce "
      "| damping ratio that ends all | queries a sample | longest | energy given, of 2 F A |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::uint64_t swung = 0, runs = 0;
  for (std::size_t f = 0; f < kFamilies.size(); ++f) {
    if (!ask.family.empty() && ask.family != kFamilies[f])
      continue;
    Sum sum;
    const auto one = [&](std::uint64_t index, const std::string& device) {
      const Choice choice{ask.seed, index, f, device, ask.times};
      const Result r = run(choice);
      sum.take(r, choice);
      const bool odd = r.swings || r.grew || r.slewed || r.flagged || r.energy_ratio > 0.01;
      if (odd || ask.only || ask.every)
        print_run(choice, r);
    };
    for (std::uint64_t n = ask.only.value_or(0); n < (ask.only ? *ask.only + 1 : ask.devices); ++n)
      one(n, ask.device);
    if (!ask.only)
      for (const std::string& file : ask.files)
        one(0, file);
    sum.print(kFamilies[f]);
    swung += sum.swings, runs += sum.runs;
  }
  fmt::print(
      "\n{} runs, {} swing. Seed {}, {} devices and {} files a family, {} times the promise.\n",
      runs, swung, ask.seed, ask.devices, ask.files.size(), ask.times);
  return swung > 0 ? 1 : 0;
}

}  // namespace
}  // namespace voxtouch::families

int main(int argc, char** argv) {
  CLI::App app{"Designed loops of random devices on walls, by family of contact."};
  voxtouch::families::Request ask;
  app.add_option("--seed", ask.seed, "of devices and runs");
  app.add_option("--devices", ask.devices, "random ones a family; 300 for the full size");
  app.add_option("--files", ask.files, "device files, each once a family more");
  app.add_option("--times", ask.times, "stiffness over the promise")->check(CLI::PositiveNumber);
  app.add_option("--family", ask.family, "one alone");
  app.add_option("--only", ask.only, "one run of each");
  app.add_flag("--every", ask.every, "print every run, not only the flagged ones");
  app.add_flag("--margins", ask.margins,
               "least and median factor over the promise at which no run swings, by family");
  app.add_option("--device", ask.device,
                 "with --only: this device file instead of a random device");
  CLI11_PARSE(app, argc, argv);
  return ask.margins ? voxtouch::families::margins(ask) : voxtouch::families::all(ask);
}

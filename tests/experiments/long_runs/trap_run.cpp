#include <fenv.h>
#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>

#include "core/device_fit/coupling_input.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/experiments/long_runs/long_runs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

/// Place of a trap.
struct Place {
  char name[64] = "";
  std::uint64_t frame = 0, seed = 0;
};
Place place;

extern "C" void print_trap(int, siginfo_t* info, void*) {
  const char* what = info->si_code == FPE_FLTDIV   ? "division by zero"
                     : info->si_code == FPE_FLTOVF ? "overflow"
                     : info->si_code == FPE_FLTINV ? "invalid operation"
                                                   : "floating-point trap";
  char text[256];
  const int length = std::snprintf(
      text, sizeof text, "%s at %p: %s, frame %llu, seed %llu\n", what, info->si_addr, place.name,
      static_cast<unsigned long long>(place.frame), static_cast<unsigned long long>(place.seed));
  if (length > 0 && write(STDERR_FILENO, text, static_cast<std::size_t>(length)) < 0)
    _exit(1);
}  // the instruction is tried again, now without a handler

/// Traps are on while it lives; the handler of this process stays.
class TrapsOn {
 public:
  TrapsOn() {
    struct sigaction action {};
    action.sa_sigaction = print_trap;
    action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND);
    sigaction(SIGFPE, &action, nullptr);
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(kTraps);
  }
  ~TrapsOn() { fedisableexcept(kTraps); }
  TrapsOn(const TrapsOn&) = delete;
  TrapsOn& operator=(const TrapsOn&) = delete;

 private:
  static constexpr int kTraps = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;
};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double log(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }
  bool chance(double p) { return uniform(0, 1) < p; }
  std::size_t below(std::size_t n) { return random_() % n; }
  Vec3 cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }

 private:
  std::mt19937_64 random_;
};

/// A tool that is shaken about the surface: tiny and large steps, jumps to other places, places
/// exactly on the grid, rests.
class Shaken {
 public:
  /// `home`: where a body is gripped and carried about; otherwise all of the surface is visited.
  Shaken(rendering::BuiltScene& built, Dice& dice, const std::optional<Vec3>& home)
      : dice_(dice),
        home_(home),
        grid_(built.voxmap().grid()),
        reach_m_(built.renderer().query().reach_m()) {
    built.voxmap().for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) {
      if (kind == voxmap::VoxelKind::kSurface)
        surface_.push_back(v);
    });
  }
  /// The body is at the tool in the first frame after this.
  void go_home() {
    if (home_)
      sample_.pose = {*home_, Quat::Identity()}, sample_.buttons = 1, rests_ = true;
  }
  const devices::DeviceSample& next(double dt_s) {
    const Vec3 before = sample_.pose.position;
    const double what = std::exchange(rests_, false) ? 1.0 : dice_.uniform(0, 1);
    if (what < 0.01)
      jump();
    else if (what < 0.02)
      on_grid();
    else if (what < 0.025)
      sample_.pose.position = dice_.cube(dice_.log(1, 1e6));  // far away, then back
    else if (what < 0.9)
      move();
    sample_.twist.linear =
        dice_.chance(0.2) ? Vec3::Zero().eval() : Vec3((sample_.pose.position - before) / 1e-3);
    sample_.twist.angular = dice_.chance(0.5) ? Vec3::Zero().eval() : dice_.cube(5.0);
    if (dice_.chance(home_ && sample_.buttons ? 0.002 : 0.02))
      sample_.buttons ^= 1U;
    sample_.time_ns += std::llround(dt_s * 1e9);
    if (what >= 0.02 && what < 0.025)
      back_ = true;
    else if (back_)
      jump(), back_ = false;
    return sample_;
  }

 private:
  void jump() {
    if (home_) {
      sample_.pose = {*home_ + dice_.cube(0.01), Quat::Identity()};
      return;
    }
    const voxmap::VoxelIndex v = surface_[dice_.below(surface_.size())];
    const Vec3 aside = dice_.cube(1.0);
    sample_.pose.position =
        grid_.centre(v) + reach_m_ * dice_.uniform(0, 1.2) * aside.stableNormalized();
    const double w = dice_.uniform(-1, 1);
    const Vec3 axis = dice_.cube(1.0);
    Quat turned(w, axis.x(), axis.y(), axis.z());
    sample_.pose.orientation =
        dice_.chance(0.3) || turned.norm() < 0.1 ? Quat::Identity() : turned.normalized();
  }
  void on_grid() {
    if (home_)
      return jump();
    const voxmap::VoxelIndex v = surface_[dice_.below(surface_.size())];
    const double half = dice_.chance(0.5) ? 0.5 : 0.0;
    sample_.pose.position = grid_.from_grid(Vec3(v.i + half, v.j, v.k + half));
    sample_.pose.orientation = Quat::Identity();
  }
  void move() {
    sample_.pose.position += dice_.cube(dice_.log(1e-9, 3e-3));
    const Vec3 turn = dice_.cube(dice_.log(1e-9, 0.05));
    sample_.pose.orientation =
        (Quat(1, turn.x(), turn.y(), turn.z()) * sample_.pose.orientation).normalized();
  }

  Dice& dice_;
  std::optional<Vec3> home_;
  voxmap::Grid grid_;
  double reach_m_;
  std::vector<voxmap::VoxelIndex> surface_;
  devices::DeviceSample sample_;
  bool back_ = false, rests_ = false;
};

coupling::CouplingSpec any_coupling(Dice& dice) {
  constexpr const char* kKinds[] = {"shaping_filter", "spring_damper", "direct"};
  coupling::CouplingSpec spec;
  spec.kind = kKinds[dice.below(3)];
  spec.cutoff_hz = dice.log(1, 150), spec.damping_ratio = dice.log(0.3, 3),
  spec.gain = dice.chance(0.1) ? 0.0 : dice.log(0.01, 3);
  spec.stiffness_n_per_m = dice.log(50, 5000), spec.damping_ns_per_m = dice.uniform(0, 20);
  if (dice.chance(0.7))
    spec.stiffness_cap_n_per_m = dice.log(10, 2000),
    spec.stiffness_cap_nm_per_rad = dice.log(0.01, 10);
  if (dice.chance(0.7))
    spec.injected_damping_ns_per_m = dice.log(0.1, 20),
    spec.injected_damping_nms_per_rad = dice.log(1e-4, 0.1);
  return spec;
}

struct Case {
  std::string name;
  scene::Scene scene;
  contact::ContactModelKind model;
  std::optional<Vec3> home;
};

/// Three scenes with every contact model: the cup with all effects that a tool may have, objects
/// that move, a body.
std::vector<Case> cases(const std::filesystem::path& folder) {
  scene::Scene cup = scene::load_scene(
      folder / "cup_field.yaml");  // its stiffness is of the area, which every model takes
  for (const char* name : {"friction", "surface_damping", "texture", "viscosity", "guide_plane",
                           "guide_line", "guide_point", "magnet", "proximity"})
    for (const effects::EffectSpec& effect :
         scene::load_scene(folder / (std::string("cup_") + name + ".yaml")).effects)
      cup.effects.push_back(effect);
  const scene::Scene block = scene::load_scene(folder / "block.yaml");
  std::vector<Case> out;
  for (const contact::ContactModelKind model :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted,
        contact::ContactModelKind::kField}) {
    out.push_back({"cup with nine effects", cup, model, {}});
    out.push_back({"objects", scene::load_scene(folder / "objects.yaml"), model, {}});
    out.push_back({"block, a body", block, model, block.motions.at("fall").path.front()});
  }
  return out;
}

struct Count {
  std::uint64_t frames = 0, touching = 0, effects = 0, pushing = 0;
};

volatile double nothing = 0.0;

void shake(const Case& c, const TrapRunOptions& ask, std::uint64_t frames, Dice& dice, Count& count,
           Findings& out) {
  constexpr std::uint64_t kPiece = 1000;
  constexpr double kPeriodS = 1e-3;
  rendering::BuildChoices choices;
  choices.model = c.model;
  std::unique_ptr<rendering::BuiltScene> built =
      rendering::build_scene(c.scene, serial_for(), choices);
  Shaken shaken(*built, dice, c.home);
  std::snprintf(place.name, sizeof place.name, "%s, %s", c.scene.name.c_str(),
                std::string(contact::name_of(c.model)).c_str());
  const DeviceDescription device =
      dice.chance(0.5) ? sim::sim_phantom().description : sim::sim_lwr().description;
  devices::ForceGuard guard(devices::guard_config(device));
  for (std::uint64_t done = 0; done < frames; done += kPiece) {
    const coupling::CouplingLimits limits =
        dice.chance(0.2) ? coupling::CouplingLimits{}
                         : coupling::CouplingLimits{device.max_force_n, device.max_torque_nm};
    coupling::RunningCoupling coupling(any_coupling(dice), limits, kPeriodS);
    rendering::DeviceMapping mapping(c.scene.device);
    if (c.home || dice.chance(0.3))
      built->scene_renderer().reset(), shaken.go_home();
    const TrapsOn traps;
    for (std::uint64_t n = 0; n < std::min(kPiece, frames - done); ++n) {
      place.frame = done + n;
      if (ask.trip_at == place.frame)
        nothing = 1.0 / nothing;
      const double dt_s = dice.chance(0.95) ? kPeriodS : kPeriodS * dice.log(1e-3, 100);
      const devices::DeviceSample& sample = shaken.next(dt_s);
      const rendering::ToolState& tool = mapping.update(sample.pose, sample.twist, sample.buttons);
      const rendering::SceneFrame frame =
          built->scene_renderer().render(tool, static_cast<double>(sample.time_ns) * 1e-9);
      const coupling::CouplingOutput answer =
          coupling.step(device_fit::coupling_input(frame, tool.pose), dt_s);
      const Wrench force = guard.pass(
          devices::GuardInput{
              rendering::wrench_to_device(c.scene.device, answer.wrench, tool.pose.orientation),
              sample.time_ns + 5'000'000},
          sample.time_ns);
      ++count.frames, count.touching += !frame.touch.contact.wrench.zero(),
          count.effects += !frame.effects.wrench.zero();
      count.pushing += !force.zero();
      if (!force.finite()) {
        out.faults.push_back(
            fmt::format("{}: frame {} gives a force that is no number", c.name, place.frame));
        return;
      }
    }
  }
}

/// The same round the whole loop, with the simulated device in it.
void loop(const TrapRunOptions& ask, std::uint64_t frames, Count& count) {
  RigOptions rig_ask;
  rig_ask.scene = ask.scenes / "cup_field.yaml", rig_ask.motion = "slide", rig_ask.seed = ask.seed;
  LoopRig rig(rig_ask);
  std::snprintf(place.name, sizeof place.name, "cup_field in the whole loop");
  const TrapsOn traps;
  for (place.frame = 0; place.frame < frames; ++place.frame) {
    count.pushing += !rig.step().zero();
    ++count.frames, count.touching += !rig.front().frame().touch.contact.wrench.zero();
  }
}

}  // namespace

Findings run_traps(const TrapRunOptions& ask, const Progress& progress) {
  Findings out;
  Dice dice(ask.seed);
  place.seed = ask.seed;
  Count all;
  const std::vector<Case> every = cases(ask.scenes);
  for (const Case& c : every) {
    Count count;
    shake(c, ask, ask.frames / (every.size() + 1), dice, count, out);
    out.lines.push_back(
        fmt::format("{:9} {:22} {} frames, {} touch, effects push in {}, the device in {}",
                    contact::name_of(c.model), c.name, count.frames, count.touching, count.effects,
                    count.pushing));
    // Couplings and places are random; with some of them a tool is repelled permanently.
    if (count.touching * 20 < count.frames || count.pushing * 20 < count.frames)
      out.faults.push_back(fmt::format("{} with {} hardly touches: nothing is tried", c.name,
                                       contact::name_of(c.model)));
    all.frames += count.frames;
    if (progress)
      progress(all.frames, ask.frames);
  }
  Count looped;
  loop(ask, ask.frames / (every.size() + 1), looped);
  out.lines.push_back(fmt::format("{:9} {:22} {} frames, {} touch, the device pushes in {}",
                                  "field", "cup, whole loop", looped.frames, looped.touching,
                                  looped.pushing));
  out.lines.push_back(
      fmt::format("{} frames without a floating-point trap", all.frames + looped.frames));
  if (progress)
    progress(ask.frames, ask.frames);
  return out;
}

}  // namespace voxtouch::long_runs

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/scene/scene_file.hpp"
#include "core/types/fnv.hpp"
#include "tests/experiments/long_runs/long_runs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kPi = std::numbers::pi;

/// A way over the outside of the cup (its axis is z) away from its handle: mostly pressed into the
/// wall by up to 3 mm, every eighth point lifted off.
Motion wandering(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Motion motion;
  double angle = 200.0 / 180.0 * kPi;
  for (int i = 0; i < 64; ++i) {
    angle = std::clamp(angle + draw(-0.3, 0.3), 160.0 / 180.0 * kPi, 240.0 / 180.0 * kPi);
    const double r = i % 8 == 0 ? 0.065 : draw(0.046, 0.0485);
    motion.path.emplace_back(r * std::cos(angle), r * std::sin(angle), draw(0.02, 0.08));
  }
  motion.speed_m_per_s = 0.08, motion.hold_s = 0.05, motion.repeat_from = 0;
  return motion;
}

/// Figures of a tenth of the run.
struct Tenth {
  double cpu_s = 0.0, force_n = 0.0, most_n = 0.0;
  std::uint64_t frames = 0, touching = 0;
};

/// The wrench's bits, mixed.
void mix(Fnv1a& hash, const Wrench& w) {
  for (const Vec3& part : {w.force, w.torque})
    hash.add({reinterpret_cast<const char*>(part.data()), sizeof part});
}

/// The answers to one fixed motion, after three seconds away from everything, which must clear all
/// state.
std::uint64_t answers(RigFront& front, std::int64_t from_ns, bool& touched) {
  Motion motion;
  motion.path = {{-0.07518, -0.02736, 0.025},
                 {-0.04435, -0.01614, 0.025},
                 {-0.03866, -0.02707, 0.07},
                 {-0.06553, -0.04589, 0.07}};
  motion.speed_m_per_s = 0.08;
  Fnv1a hash;
  for (std::int64_t n = 0; n < 5000; ++n) {
    const MotionPoint at = motion_at(motion, 1e-3 * static_cast<double>(n - 3000));
    devices::DeviceSample sample;
    sample.time_ns = from_ns + n * 1'000'000;
    sample.pose.position = at.position, sample.twist.linear = at.velocity;
    const Wrench wrench = front.answer(sample);
    if (n < 3000)
      continue;
    mix(hash, wrench);
    touched |= !wrench.zero();
  }
  return hash.value();
}

std::uint64_t play(LoopRig& rig, std::uint64_t frames, Tenth& tenth, Findings& out) {
  const double begin = thread_seconds();
  const double most = rig.guard().config().max_force_n;
  for (std::uint64_t n = 0; n < frames; ++n) {
    const Wrench& force = rig.step();
    const double magnitude = force.force.norm();
    if (!(magnitude <= most)) {
      out.faults.push_back(
          fmt::format("frame {}: {} N reach the device", rig.sequence(), magnitude));
      return 0;
    }
    ++tenth.frames;
    if (!rig.front().frame().touch.contact.wrench.zero())
      ++tenth.touching, tenth.force_n += magnitude;
    tenth.most_n = std::max(tenth.most_n, magnitude);
  }
  tenth.cpu_s += thread_seconds() - begin;
  return frames;
}

void judge(const LoopRig& rig, const Tenth& first, const Tenth& last, Findings& out) {
  const coupling::CouplingCounters& c = rig.front().counters();
  const double mean_first =
                   first.force_n / static_cast<double>(std::max<std::uint64_t>(first.touching, 1)),
               mean_last =
                   last.force_n / static_cast<double>(std::max<std::uint64_t>(last.touching, 1));
  out.lines.push_back(
      fmt::format("in contact {:.0f} % (first tenth {:.0f} %), mean force there {:.4f} N ({:.4f} "
                  "N), largest {:.2f} N ({:.2f} N)",
                  100.0 * static_cast<double>(last.touching) / static_cast<double>(last.frames),
                  100.0 * static_cast<double>(first.touching) / static_cast<double>(first.frames),
                  mean_last, mean_first, last.most_n, first.most_n));
  out.lines.push_back(
      fmt::format("coupling: {} samples, lowest energy {:.2g} J, {} capped, swung for {:.2g} s; "
                  "guard: {} clamped, {} refused",
                  c.samples, c.lowest_energy_j, c.capped, c.swing.duration_s,
                  rig.guard().counts().clamped(), rig.guard().counts().refused()));
  const double q = rig.front().frame().object.orientation.norm();
  if (last.touching == 0)
    out.faults.push_back("the tool does not touch any more");
  if (c.faults || c.repeated || c.not_finite || c.pose_jumps || rig.refused_writes() ||
      rig.guard().counts().refused())
    out.faults.push_back(
        fmt::format("faults where none were given: {} bad samples, {} held, {} not finite, {} "
                    "jumps, {} refused",
                    c.faults, c.repeated, c.not_finite, c.pose_jumps, rig.refused_writes()));
  if (!(std::abs(q - 1.0) < 1e-14))
    out.faults.push_back(fmt::format("the tool's quaternion has the norm 1 + {:.2g}", q - 1.0));
  // A tenth of many rounds (one takes a minute and a half) is as every other; of a few it is not.
  constexpr std::uint64_t kManyRounds = 900'000;
  if (last.frames >= kManyRounds && !(std::abs(mean_last - mean_first) < 0.02 * mean_first))
    out.faults.push_back(
        fmt::format("the mean force went from {} N to {} N", mean_first, mean_last));
}

}  // namespace

Findings run_contact(const ContactRunOptions& ask, const Progress& progress) {
  Findings out;
  RigOptions rig_ask;
  rig_ask.scene = ask.scene, rig_ask.path = wandering(ask.seed), rig_ask.seed = ask.seed;
  contact::ContactModelKind kind{};
  if (contact::parse_contact_model(ask.model, kind))
    rig_ask.model = kind;
  sim::OperatorConfig hand = rig_ask.device.hand;
  hand.tremor_n = 0.02;
  rig_ask.hand = hand;
  LoopRig rig(rig_ask);

  Tenth tenths[10];
  std::optional<Memory> early;
  std::uint64_t played = 0;
  for (Tenth& tenth : tenths) {
    for (int piece = 0; piece < 10; ++piece) {
      const std::uint64_t done = play(rig, ask.frames / 100, tenth, out);
      if (done == 0)
        return out;
      played += done;
      if (progress)
        progress(played, ask.frames);
    }
    if (!early)
      early = memory_in_use();
  }
  const Memory late = memory_in_use();
  out.resident_growth = late.resident - early->resident, out.heap_growth = late.heap - early->heap;
  out.slow_down = tenths[9].cpu_s / tenths[0].cpu_s;
  out.lines.push_back(fmt::format("{} frames, {:.2f} us of CPU each", played,
                                  tenths[9].cpu_s / static_cast<double>(tenths[9].frames) * 1e6));
  judge(rig, tenths[0], tenths[9], out);
  // No frame allocates; the rest is for the progress.
  if (out.heap_growth > 4096)
    out.faults.push_back(fmt::format("the heap grew by {} bytes", out.heap_growth));
  if (out.resident_growth > 1'000'000)
    out.faults.push_back(fmt::format("memory grew by {} bytes", out.resident_growth));

  bool touched = false, touched_new = false;
  const std::uint64_t worn = answers(rig.front(), rig.device().time_ns() + 1'000'000, touched);
  const std::uint64_t as_new = answers(*rig.fresh_front(), 0, touched_new);
  if (!touched || !touched_new)
    out.faults.push_back("the fixed motion does not touch");
  if (worn != as_new)
    out.faults.push_back("what has run answers a fixed motion with other bits than what is new");
  return out;
}

}  // namespace voxtouch::long_runs

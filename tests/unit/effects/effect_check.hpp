#pragma once
/// Checks of every spatial effect: force compared with potential, stiffness with finite
/// differences, work on closed paths, and no step.
#include <initializer_list>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "core/effects/effect_chain.hpp"

namespace voxtouch::test {

/// A scene's effect of that kind, its values by name.
effects::EffectSpec effect(
    std::string_view kind,
    std::initializer_list<std::pair<std::string_view, std::array<double, 3>>> values,
    const effects::Region& region = {});

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  bool coin() { return number(0, 1) < 0.5; }
  Vec3 vector(double size) {
    return {number(-size, size), number(-size, size), number(-size, size)};
  }
  Vec3 direction();
  Quat orientation();
  std::array<double, 3> three(double size) { return as_array(vector(size)); }
  static std::array<double, 3> as_array(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

 private:
  std::mt19937_64 engine_;
};

/// One effect on its own, at poses of a tool at rest.
class Bench {
 public:
  explicit Bench(const effects::EffectSpec& spec, const effects::Proximity* proximity = nullptr,
                 std::span<const effects::ToolPoint> points = {})
      : spec_(spec),
        chain_({spec}),
        proximity_(proximity),
        points_(points) {}
  effects::EffectForce at(const Pose& pose) noexcept;
  const effects::EffectSpec& spec() const noexcept { return spec_; }
  effects::EffectChain& chain() noexcept { return chain_; }

 private:
  effects::EffectSpec spec_;
  effects::EffectChain chain_;
  const effects::Proximity* proximity_;
  std::span<const effects::ToolPoint> points_;
};

/// Wrench = -grad U at `pose` by central differences over `step` metres; with `with_rotation` also
/// the torque, by `step` / 0.01 rad.
void expect_force_of_potential(Bench& bench, const Pose& pose, double tolerance_n,
                               bool with_rotation = false, double step = 1e-6);

/// At `pose`: -dF/dx by central differences is within both bounds. The matrix is symmetric,
/// semidefinite and no smaller than -dF/dx in any direction (its symmetric part); torque and
/// rotation too if `with_rotation`.
void expect_stiffness_covers(Bench& bench, const Pose& pose, double tolerance,
                             bool with_rotation = false, double step = 1e-7);

/// A closed path: sums of sines round `centre`; straight between `steps` poses.
std::vector<Pose> closed_path(Random& random, const Vec3& centre, double size_m,
                              double rotation_rad, std::size_t steps);

struct Work {
  double net_j = 0.0;    ///< given to the hand
  double moved_j = 0.0;  ///< sum of all |F dx|
};
/// By the midpoint rule. For a force with a Lipschitz constant K its error is at most K d^2 / 4 for
/// a step d; for a smooth force of order d^3.
Work work_along(Bench& bench, const std::vector<Pose>& path, bool with_rotation = false);

/// Largest change of the wrench's force between neighbours on a straight sweep, over the sweep's
/// step times the bound: 1 at most if there is no step.
double steepest_on_sweep(Bench& bench, const Vec3& from, const Vec3& to, std::size_t steps,
                         double bound_n_per_m);

}  // namespace voxtouch::test

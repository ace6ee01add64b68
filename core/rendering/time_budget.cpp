#include "core/rendering/time_budget.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/contact/contact_renderer.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::rendering {
namespace {

double effects_ns(const scene::Scene& scene, const FrameWork& work) {
  double ns = 0.0;
  for (effects::EffectSpec effect : scene.effects) {
    effect.on = true;  // it may be switched on at any time
    ns += expected_ns(effect, work.tool_points);
  }
  return ns;
}

/// Of a frame beside its points: the look-up of every object, and the effects.
double fixed_ns(const scene::Scene& scene, const FrameWork& work) {
  return static_cast<double>(work.objects) * kNsPerLookup + effects_ns(scene, work);
}

}  // namespace

double ns_per_budget_point(contact::ContactModelKind model) noexcept {
  return kNsPerPoint + ns_per_contact_point(contact::name_of(model)) + kNsPerLevelPoint;
}

std::uint32_t points_within(double budget_us, const scene::Scene& scene, const FrameWork& work) {
  const double each = ns_per_budget_point(work.model) * static_cast<double>(work.objects),
               fixed = fixed_ns(scene, work);
  const std::uint64_t least =
      std::min<std::uint64_t>(contact::FrameBudget::kMinPoints, work.shell_points);
  const double points = std::floor((1e3 * budget_us - fixed) / each);
  if (!(points >= static_cast<double>(least)))
    throw std::invalid_argument(
        fmt::format("{}: 'budget_us' is {:g}, but a frame of this scene takes up to {:g} us beside "
                    "its points, and keeps no contact that it had with fewer "
                    "than {} points, at {:g} ns each. Say at least {:.0f}, or choose a cheaper "
                    "contact model or fewer effects.",
                    scene.file.string(), budget_us, 1e-3 * fixed, least, each,
                    std::ceil(1e-3 * (fixed + each * static_cast<double>(least)))));
  return static_cast<std::uint32_t>(std::min(points, 4e9));
}

double tool_ns_within(double budget_us, const scene::Scene& scene, const FrameWork& work) {
  return std::max(0.0, 1e3 * budget_us - effects_ns(scene, work));
}

double least_tool_ns(const FrameWork& work) noexcept {
  const double query = static_cast<double>(work.objects) *
                           (kNsPerFrame + (kNsPerPoint + kNsPerFieldPoint) *
                                              static_cast<double>(work.shell_points)) +
                       edge_ns(work.objects, work.edge_points);
  return contact::limits::kMinQueries * (query + contact::limits::kMaxIterations * kNsPerIteration);
}

}  // namespace voxtouch::rendering

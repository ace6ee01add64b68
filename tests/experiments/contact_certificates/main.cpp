/// contact_certificates: designs a coupling for each device and prints which contacts it is
/// certified for, with times. Each case of device, hand and timing is tried by itself too. Exit
/// status 1 if a loop is certified above its linear limit.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "core/coupling/design/absolute_stability.hpp"
#include "core/coupling/design/axis_verdict.hpp"
#include "core/device_fit/design_problem.hpp"
#include "core/scene/device_file.hpp"
#include "devices/registry.hpp"
#include "tests/support/coupling_models/population.hpp"

namespace voxtouch {
namespace {

namespace cd = coupling::design;

struct Arguments {
  std::vector<std::string> devices;
  std::uint64_t random = 0, seed = 1;
};

/// As `voxtouch design` without a scene: the device's limit, with the hand of its grip.
cd::DesignProblem problem_of(const std::string& device) {
  const bool file = device.ends_with(".yaml");
  const cd::DeviceModel model = cd::model_of(file ? scene::load_device_file(device).description
                                                  : devices::describe_device(device));
  scene::Scene scene;
  scene.voxel_size_m = 0.0;
  scene.design.emplace();
  const double max_rotation = model.gives_torque ? model.rotation.max_stiffness : 0.0;
  cd::DesignProblem problem = device_fit::design_problem(
      scene, model, {0.01 * model.translation.max_stiffness, model.translation.max_stiffness},
      {0.01 * max_rotation, max_rotation});
  problem.device.name = file ? std::filesystem::path(device).stem().string() : device;
  return problem;
}

/// Member `index` of population `seed`; every fourth also rotates, with an arm of 3 to 15 cm.
cd::DesignProblem random_problem(std::uint64_t seed, std::uint64_t index) {
  const coupling_models::PopulationMember member = coupling_models::draw_member(seed, index);
  cd::DesignProblem problem;
  problem.device = member.device;
  problem.device.name = fmt::format("random {}", index);
  problem.hand.translation = member.hand;
  problem.contact = member.contact;
  problem.goals.free_cap = true;
  if (index % 4 != 3)
    return problem;
  coupling_models::Random random(seed + 1, index);
  const double arm = random.log_uniform(0.03, 0.15), squared = arm * arm;
  cd::AxisModel& rotation = problem.device.rotation = problem.device.translation;
  problem.device.gives_torque = true;
  for (double* const of_arm_squared :
       {&rotation.inertia_min, &rotation.inertia_max, &rotation.damping, &rotation.max_stiffness})
    *of_arm_squared *= squared;
  rotation.resolution /= arm;
  rotation.max_effort *= arm;
  rotation.coulomb_friction *= arm;
  cd::HandRange& hand = problem.hand.rotation = member.hand;
  for (double* const of_arm_squared : {&hand.mass_min, &hand.mass_max, &hand.damping_min,
                                       &hand.damping_max, &hand.stiffness_min, &hand.stiffness_max})
    *of_arm_squared *= squared;
  problem.contact_rotation = {member.contact.one_point * squared,
                              member.contact.all_points * squared};
  return problem;
}

/// Figures over all devices.
struct Totals {
  int devices = 0, infeasible = 0, passive = 0, monotone = 0, rotation = 0, cases = 0, reached = 0,
      circle = 0, above = 0;
  std::vector<double> ratios, margins, ms;
};

double now_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Each loop separately: certified at 0.99 of its limit, at 1.001 of it; and the number that needs
/// only the multiplier 1.
void try_each_case(const cd::DesignProblem& problem, const coupling::CouplingSpec& spec,
                   Totals& totals) {
  if (spec.kind == "spring_damper")
    return;
  for (const cd::AxisProblem& axis : cd::axis_problems(problem)) {
    const cd::LoopController law = cd::controller_of(spec, axis, cd::arm_squared(problem));
    for (const cd::DesignCase& one : axis.cases) {
      const double limit = cd::critical_stiffness(one.plant, law).stiffness;
      if (!std::isfinite(limit))
        continue;
      const auto loop = [&](double ratio) {
        const double stiffness = ratio * limit;
        return std::array{cd::ContactLoop{cd::loop_over_arc(one.plant, law), 1.0 / stiffness,
                                          cd::kMultiplierFloor / stiffness}};
      };
      ++totals.cases;
      totals.reached += cd::find_multiplier(loop(0.99)).has_value();
      totals.circle += cd::prove(cd::Multiplier{}, loop(0.99)).holds();
      totals.above += cd::find_multiplier(loop(1.001)).has_value();
    }
  }
}

void certify(const cd::DesignProblem& problem, Totals& totals) {
  const cd::Design design = cd::design_coupling(problem);
  ++totals.devices;
  if (design.status == cd::DesignStatus::kInfeasible) {
    ++totals.infeasible;
    return;
  }
  const double start = now_ms();
  const cd::ContactCertificate c = cd::certify_contacts(problem, design);
  const double ms = now_ms() - start;
  totals.monotone += c.contact == cd::ContactClass::kMonotone;
  if (c.proof == cd::MonotoneProof::kPassivity) {
    ++totals.passive;
    return;
  }
  totals.ratios.push_back(c.ratio_of_linear);
  totals.ms.push_back(ms);
  for (const auto& axis : c.axes)
    totals.margins.push_back(axis.margin);
  totals.rotation += c.axes.size() > 1;
  try_each_case(problem, design.spec, totals);
  fmt::print("{:<14} {:<14} {:>5} {:>6.3f} {:>9.4g} {:>7.3g} {:>7.3g} {:>9} {:>7} {:>7.0f}\n",
             problem.device.name, design.spec.kind, c.loops, c.ratio_of_linear, c.axes[0].stiffness,
             c.axes[0].margin, design.translation.gain_margin,
             c.axes.size() > 1 ? fmt::format("{:.4g}", c.axes[1].stiffness) : "-",
             c.axes.size() > 1 ? fmt::format("{:.3g}", c.axes[1].margin) : "-", ms);
}

std::string least_and_median(std::vector<double> values) {
  if (values.empty())
    return "-";
  std::ranges::sort(values);
  return fmt::format("least {:.3g}, median {:.3g}, most {:.3g}", values.front(),
                     values[values.size() / 2], values.back());
}

int run(const Arguments& a) {
  Totals totals;
  fmt::print("{:<14} {:<14} {:>5} {:>6} {:>9} {:>7} {:>7} {:>9} {:>7} {:>7}\n", "device",
             "coupling", "loops", "ratio", "K [N/m]", "margin", "linear", "K [Nm]", "margin", "ms");
  for (const std::string& device : a.devices)
    certify(problem_of(device), totals);
  for (std::uint64_t i = 0; i < a.random; ++i)
    certify(random_problem(a.seed, i), totals);
  fmt::print("\ndevices {}, infeasible {}, by passivity {}, any contact {} (seed {})\n",
             totals.devices, totals.infeasible, totals.passive, totals.monotone, a.seed);
  fmt::print("one multiplier: {} devices, {} of them with torque; ratio to the linear limit: {}\n",
             totals.ratios.size(), totals.rotation, least_and_median(totals.ratios));
  fmt::print("margin over what is displayed: {}\n", least_and_median(totals.margins));
  fmt::print(
      "cases by themselves: {}; certified at 0.99 of their limit {}, by the circle criterion {}; "
      "above it {}\n",
      totals.cases, totals.reached, totals.circle, totals.above);
  fmt::print("milliseconds: {}\n", least_and_median(totals.ms));
  return totals.above == 0 ? 0 : 1;
}

}  // namespace
}  // namespace voxtouch

int main(int argc, char** argv) {
  voxtouch::Arguments a;
  CLI::App app(
      "Prints which contacts designed couplings are certified for: ratio is K over the stiffness "
      "at which the first of the\n"
      "same loops becomes unstable, margin is K over what is displayed, linear the margin of the "
      "linear certificate.");
  app.add_option("devices", a.devices, "device files, sim-phantom, sim-lwr");
  app.add_option("--random", a.random, "how many random devices");
  app.add_option("--seed", a.seed, "of the random devices");
  CLI11_PARSE(app, argc, argv);
  return voxtouch::run(a);
}

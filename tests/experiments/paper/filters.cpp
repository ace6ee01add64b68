// Figure 11: output of three couplings for the force on a sphere around a cylinder.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/running_coupling.hpp"
#include "tests/experiments/paper/experiments.hpp"

namespace voxtouch::paper {
namespace {

constexpr double kStepS = 0.001, kSpeed = 0.1, kCylinder = 20 * kEdge, kDepthEdges = 1.0;

/// Newtons per unit of the contact model's force, so that the mean is 1 N.
std::vector<double> pass(const coupling::CouplingSpec& spec, const std::vector<Vec3>& raw,
                         double stiffness) {
  coupling::RunningCoupling coupling(spec, {}, kStepS, 1e-9);
  std::vector<double> out;
  for (const Vec3& force : raw) {
    coupling::CouplingInput input;
    input.contact.force = force;
    input.contact_stiffness_n_per_m = stiffness;
    input.contact_stiffness.topLeftCorner<3, 3>().diagonal().setConstant(stiffness);
    out.push_back(coupling.step(input, kStepS).wrench.force.norm());
  }
  return out;
}

/// In the frame that rotates with the normal, only noise is left.
std::vector<Vec3> raw_force(const Slide& slide, const Ground& ground, const Sphere& sphere) {
  contact::ContactRenderer renderer = renderer_of(all_contact_cases()[1], ground, sphere);
  const double length = 2.0 * std::numbers::pi * (kCylinder + kRadius);
  const int steps = static_cast<int>(length / (kSpeed * kStepS));
  std::vector<Vec3> out;
  double mean = 0.0;
  for (int n = 0; n < steps; ++n) {
    const double s = static_cast<double>(n) / steps;
    const Vec3 force = renderer.probe({slide.centre(s), slide.turn}).wrench.force;
    out.push_back(Quat::FromTwoVectors(slide.normal(s), Vec3::UnitX()) * force);
    mean += out.back().norm() / steps;
  }
  for (Vec3& force : out)
    force /= mean;
  return out;
}

/// Without the first half second, in which the couplings settle.
Smoothness smoothness(const std::vector<double>& all) {
  const std::vector<double> force(all.begin() + 500, all.end());
  Smoothness out;
  out.noise = test::noise(force);
  double mean = 0.0;
  for (const double f : force)
    mean += f / static_cast<double>(force.size());
  for (std::size_t n = 1; n < force.size(); ++n)
    out.largest_step = std::max(out.largest_step, std::abs(force[n] - force[n - 1]) / mean);
  return out;
}

/// Until 90 % of a step.
double rise_time_s(const coupling::CouplingSpec& spec) {
  const std::vector<double> answer = pass(spec, std::vector<Vec3>(2000, Vec3::UnitX()), 100);
  const auto there = std::find_if(answer.begin(), answer.end(),
                                  [&](double f) { return f >= 0.9 * answer.back(); });
  return kStepS * static_cast<double>(there - answer.begin());
}

}  // namespace

FilterExperiment filter_experiment() {
  const Sphere sphere;
  const Slide slide = round_a_cylinder(
      kCylinder, kDepthEdges, Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())), 0.0007);
  const Ground ground(slide.mesh);
  const std::vector<Vec3> raw = raw_force(slide, ground, sphere);
  coupling::CouplingSpec filter, spring;
  filter.kind = "shaping_filter", filter.cutoff_hz = 5.0, filter.damping_ratio = 1.0,
  filter.gain = 1.0;
  spring.kind = "spring_damper", spring.stiffness_n_per_m = 1000.0, spring.damping_ns_per_m = 10.0;
  FilterExperiment out;
  out.step_s = kStepS;
  for (const Vec3& f : raw)
    out.raw.push_back(f.norm());
  out.spring_damper = pass(spring, raw, 100.0);
  out.shaping_filter = pass(filter, raw, 100.0);
  out.of_raw = smoothness(out.raw), out.of_spring_damper = smoothness(out.spring_damper),
  out.of_filter = smoothness(out.shaping_filter);
  out.rise_time_s = rise_time_s(filter);
  return out;
}

std::vector<Merit> filter_merits() {
  const FilterExperiment e = filter_experiment();
  const std::string setup = "cylinder of 20 e, 1 e deep, 0.1 m/s, adapted; ";
  const auto one = [](const std::string& what, double ours, double reference,
                      const std::string& conditions) {
    return Merit{what, ours, ours, ours, reference, conditions};
  };
  return {
      one("noise of the raw force over its mean", e.of_raw.noise, 0.19,
          setup + "falls with the depth: 0.40 at 0.5 e"),
      one("noise behind a 5 Hz filter", e.of_filter.noise, 0.076,
          setup + "falls with the speed, as voxels pass faster: 0.10 at 0.05 m/s, 0.06 at 0.2 m/s"),
      one("largest step in a millisecond, raw", e.of_raw.largest_step, 0.28,
          setup + "the largest of about 3,300"),
      one("largest step in a millisecond behind the filter", e.of_filter.largest_step, 0.008,
          setup + "the largest of about 3,300; goes with the raw step, and with how many points "
                  "enter at once"),
      one("rise time of the filter, to 90 % [s]", e.rise_time_s, 0.124, "d = 1, 5 Hz: 3.89 / w0")};
}

}  // namespace voxtouch::paper

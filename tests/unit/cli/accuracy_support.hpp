#pragma once
/// Rows as a run would give them.
#include "nodes/cli/accuracy/accuracy_report.hpp"

namespace voxtouch::test {

inline accuracy::AccuracyRow accuracy_row(contact::ContactModelKind model,
                                          contact::PointWeights weights, double voxel_m,
                                          double time_us, double direction_deg) {
  accuracy::AccuracyRow r;
  r.setting = {model, weights, voxel_m, voxel_m};
  r.shell_points = 1300;
  r.bytes = 300'000;
  r.contacts = 40;
  r.missed = 10;
  r.force_ratio = 0.9;
  r.direction_mean_deg = direction_deg;
  r.direction_median_deg = 0.8 * direction_deg;
  r.direction_median_95 = {0.7 * direction_deg, 0.9 * direction_deg};
  r.depths.resize(2);
  r.depths[0].edges = 0.25, r.depths[0].contacts = 40, r.depths[0].direction_mean_deg = 3.0,
  r.depths[0].force_ratio = 0.875;
  r.depths[1].edges = 4.0, r.depths[1].contacts = 30, r.depths[1].missed = 10,
  r.depths[1].direction_mean_deg = 45.0, r.depths[1].force_ratio = 0.125;
  r.phases.phases = 4, r.phases.contacts = 40;
  r.phases.missed_ratio = {0.1, 0.5}, r.phases.direction_mean_deg = {2.0, 90.0},
  r.phases.force_ratio = {0.5, 1.5};
  r.direction_p95_deg = 2.0 * direction_deg;
  r.magnitude_noise = 0.05 * direction_deg;
  r.torque_error_m = 1e-4;
  r.onset_error_m = -2e-4;
  r.onset_worst_m = 5e-4;
  r.median_us = time_us;
  r.p95_us = 2.0 * time_us;
  r.worst_us = 3.0 * time_us;
  r.build_s = 0.25;
  return r;
}

/// Rows 0, 2 and 3 are the front, row 2 its knee; row 4 was refused, row 5 never met the wall.
inline cli::AccuracyReport accuracy_report(const accuracy::AccuracyGoal& goal = {}) {
  cli::AccuracyReport r;
  r.scene = "cup & saucer";
  r.scene_hash = "0123456789abcdef";
  r.scene_voxel_m = 0.002;
  r.seed = 7, r.contacts = 40, r.depth_edges = 0.5;
  r.goal = goal;
  r.rows = {
      accuracy_row(contact::ContactModelKind::kOriginal, contact::PointWeights::kOne, 0.004, 5, 8),
      accuracy_row(contact::ContactModelKind::kAdapted, contact::PointWeights::kOne, 0.002, 20,
                   2.3),
      accuracy_row(contact::ContactModelKind::kField, contact::PointWeights::kArea, 0.004, 10, 0.5),
      accuracy_row(contact::ContactModelKind::kField, contact::PointWeights::kArea, 0.001, 90,
                   0.05),
      {},
      {}};
  r.rows[4].setting = {contact::ContactModelKind::kField, contact::PointWeights::kArea, 0.0001,
                       0.0001};
  r.rows[4].refused = "it would need 80 GB, \"too much\" <here>";
  r.rows[5].setting = {contact::ContactModelKind::kField, contact::PointWeights::kArea, 0.5, 0.5};
  r.rows[5].shell_points = 8;
  r.advice = accuracy::advise(r.rows, goal);
  r.machine = {.version = "0.1.0",
               .processor = "Some(R) CPU",
               .cpus = 2,
               .compiler = "gcc 12",
               .flags = "-O3"};
  r.load_before = 0.5, r.load_after = 1.5;
  return r;
}

}  // namespace voxtouch::test

#include "tests/experiments/stability_map/sliding_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/voxmap/voxelise.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::sliding {
namespace {

constexpr double kStepEdges = 0.05;

double drawn(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// The ball is askew in its own grid, as a tool is.
const test::Ball& ball() {
  static const test::Ball one(Bench::kRadiusM, 4);
  return one;
}

mesh::TriangleMesh plane(const Quat& turn) {
  return test::box_mesh(Vec3(0.06, 0.06, 0.04), {turn * Vec3(0, 0, -0.02), turn});
}

/// Which voxel each point was in, so that border crossings can be counted: only of points that are
/// hits before or after.
class Crossings {
 public:
  explicit Crossings(std::size_t points) : last_(points), seen_(points, 0) {}
  /// The weights of the points that are in another voxel than in the frame before, or came, or
  /// went.
  double count(const contact::HitList& hits, const voxmap::Grid& grid) {
    ++frame_;
    double sum = 0.0, stayed = 0.0, now = 0.0;
    for (const contact::Hits* list : {&hits.surface, &hits.interior})
      for (const contact::Hit& hit : *list) {
        const voxmap::VoxelIndex v =
            voxmap::Grid::voxel_of((hits.pose_WT.position + hit.arm - grid.origin) / grid.edge);
        now += hit.weight;
        if (seen_[hit.point] + 1 == frame_) {
          stayed += hit.weight;
          if (v != last_[hit.point])
            sum += hit.weight;
        } else {
          sum += hit.weight;
        }
        last_[hit.point] = v, seen_[hit.point] = frame_;
      }
    sum += frame_ > 2 ? std::max(0.0, before_ - stayed) : 0.0;  // gone
    before_ = now;
    return frame_ > 2 ? sum : 0.0;
  }

 private:
  std::vector<voxmap::VoxelIndex> last_;
  std::vector<std::uint64_t> seen_;
  std::uint64_t frame_ = 1;
  double before_ = 0.0;
};

struct Loop {
  double energy_j = 0.0, force_sum = 0.0, path_m = 0.0, crossed = 0.0, largest_step = 0.0;
  int frames = 0;
};

/// Work of the contact on the hand along the closed way of `count` poses, by the trapezoid rule:
/// what is there next to the lag of a held force, which goes to zero with the period.
template <class PoseOf>
Loop go_round(contact::ContactRenderer& renderer, int count, const PoseOf& pose_of) {
  Loop loop;
  Crossings crossings(renderer.query().shell().size());
  const voxmap::Grid& grid = renderer.query().voxmap().grid();
  Pose last = pose_of(0);
  Vec3 force = renderer.render(last).contact.wrench.force;
  crossings.count(renderer.hits(), grid);
  for (int n = 1; n <= count; ++n) {
    const Pose pose = pose_of(n % count);
    const Vec3 now = renderer.render(pose).contact.wrench.force,
               displacement = pose.position - last.position;
    loop.energy_j += 0.5 * (force + now).dot(displacement);
    loop.force_sum += now.norm();
    loop.path_m += displacement.norm();
    loop.crossed += crossings.count(renderer.hits(), grid);
    loop.largest_step = std::max(loop.largest_step, (now - force).norm());
    last = pose, force = now;
    ++loop.frames;
  }
  return loop;
}

}  // namespace

Bench::Bench(double radius_voxels, double tilt_deg)
    : edge_(kRadiusM / radius_voxels),
      turn_(Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180.0, Vec3(2, 1, 0).normalized())),
      shell_(test::exact_shell(ball().mesh, edge_)),
      voxmap_(
          voxmap::voxelise(plane(turn_), voxmap::default_grid(plane(turn_), edge_), serial_for())),
      field_(voxmap::build_distance_field(
          plane(turn_), voxmap_, {.depth_voxels = 4.0, .band_voxels = 2.0}, serial_for())) {}

contact::ContactRenderer Bench::renderer(contact::ContactModelKind model) const {
  return {voxmap_, shell_, model, {kPressure, contact::PointWeights::kArea}, &field_};
}

Pose Bench::at(double x, double y, double depth_m) const {
  return ball().posed(turn_ * Vec3(x, y, kRadiusM - depth_m), Quat::Identity());
}

Created Bench::worst_loop(contact::ContactModelKind model, double depth_voxels, int loops,
                          std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  contact::ContactRenderer contact = renderer(model);
  const double round_m = std::max(0.2 * kRadiusM, 3.0 * edge_), depth_m = depth_voxels * edge_;
  const int count =
      static_cast<int>(std::ceil(2.0 * std::numbers::pi * round_m / (kStepEdges * edge_)));
  Created worst;
  for (int n = 0; n < loops; ++n) {
    const double x = 4.0 * edge_ * drawn(random), y = 4.0 * edge_ * drawn(random);
    for (const double displacement : {1.0, -1.0}) {
      const auto pose_of = [&](int k) {
        const double angle = displacement * 2.0 * std::numbers::pi * k / count;
        return at(x + round_m * std::cos(angle), y + round_m * std::sin(angle), depth_m);
      };
      contact.reset();
      for (double above = 1.0; above > 0.0; above -= 0.1)  // from outside, as a hand comes
        contact.render(at(x + round_m, y, depth_m - above * (1.0 + depth_voxels) * edge_));
      const Loop loop = go_round(contact, count, pose_of);
      if (!(loop.force_sum > 0.0))
        continue;
      const double mean = loop.force_sum / loop.frames;
      worst.fraction = std::max(worst.fraction, loop.energy_j / (mean * loop.path_m));
      worst.mean_force_n = std::max(worst.mean_force_n, mean);
      worst.largest_step = std::max(worst.largest_step, loop.largest_step / mean);
      if (loop.crossed > 0.0)
        worst.per_crossing = std::max(worst.per_crossing,
                                      loop.energy_j / (kPressure * edge_ * edge_ * loop.crossed));
    }
  }
  return worst;
}

}  // namespace voxtouch::sliding

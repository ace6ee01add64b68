#include "tests/bench/bench_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/bench/bench_sizes.hpp"

namespace voxtouch::bench {
namespace {

constexpr std::int32_t kReach = 82;

bool solid(std::int32_t i, std::int32_t j, std::int32_t k) {
  const double x = i + 0.5, y = j + 0.5, z = k + 0.5, squared = x * x + y * y;
  return z > 0.0 && z < kHeight && squared < kOuter * kOuter &&
         (z < kFloor || squared > kInner * kInner);
}

std::uint64_t spread(std::uint64_t v) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < 20; ++bit)
    out |= (v >> bit & 1U) << (3 * bit);
  return out;
}

/// Point n of `count` on the plug: hemisphere, flank, lid, wound about its axis.
void plug_point(double fraction, double angle, Vec3& place, Vec3& inward) {
  const double dome = 2.0 * kInner, flank = 2.0 * kPlugLength, lid = kInner;  // areas over pi r
  double at = fraction * (dome + flank + lid);
  const double c = std::cos(angle), s = std::sin(angle);
  if (at < dome) {
    const double z = at / dome - 1.0, ring = std::sqrt(1.0 - z * z);
    inward = -Vec3(ring * c, ring * s, z);
    place = -kInner * inward;
  } else if ((at -= dome) < flank) {
    inward = -Vec3(c, s, 0.0);
    place = Vec3(kInner * c, kInner * s, at / flank * kPlugLength);
  } else {
    const double ring = kInner * std::sqrt(std::max(0.0, 1.0 - (at - flank) / lid));
    inward = -Vec3::UnitZ();
    place = Vec3(ring * c, ring * s, kPlugLength);
  }
}

}  // namespace

voxmap::Voxmap cup() {
  const voxmap::Grid grid{kEdge * Vec3(0.06, 0.08, 0.1), kEdge};
  voxmap::Voxmap out(grid, {-kReach, -kReach, 0},
                     {kReach, kReach, static_cast<std::int32_t>(kHeight)});
  for (std::int32_t i = -kReach; i <= kReach; ++i)
    for (std::int32_t j = -kReach; j <= kReach; ++j)
      for (std::int32_t k = 0; k < static_cast<std::int32_t>(kHeight); ++k) {
        if (!solid(i, j, k))
          continue;
        const bool inside = solid(i - 1, j, k) && solid(i + 1, j, k) && solid(i, j - 1, k) &&
                            solid(i, j + 1, k) && solid(i, j, k - 1) && solid(i, j, k + 1);
        out.set({i, j, k}, inside ? voxmap::VoxelKind::kInterior : voxmap::VoxelKind::kSurface);
      }
  out.finish();
  return out;
}

std::string name_of(Place place) {
  switch (place) {
    case Place::kFar:
      return "far";
    case Place::kNear:
      return "near";
    case Place::kLight:
      return "light";
    case Place::kHeavy:
      return "heavy";
  }
  return "";
}

pointshell::Pointshell tool(Place place, std::size_t points) {
  std::vector<Vec3> at(points), inward(points);
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t n = 0; n < points; ++n) {
    const double fraction = (static_cast<double>(n) + 0.5) / static_cast<double>(points),
                 angle = golden * static_cast<double>(n);
    if (place == Place::kHeavy) {
      plug_point(fraction, angle, at[n], inward[n]);
    } else {
      const double z = 1.0 - 2.0 * fraction, ring = std::sqrt(1.0 - z * z);
      inward[n] = -Vec3(ring * std::cos(angle), ring * std::sin(angle), z);
      at[n] = -kBall * inward[n];
    }
  }
  std::vector<std::uint64_t> key(points);
  for (std::size_t n = 0; n < points; ++n)
    for (int axis = 0; axis < 3; ++axis)
      key[n] |= spread(static_cast<std::uint64_t>(1000.0 * (at[n][axis] + 200.0))) << axis;
  std::vector<std::size_t> order(points);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  pointshell::Pointshell out;
  out.edge = kEdge;
  for (const std::size_t n : order) {
    out.x.push_back(kEdge * at[n].x()), out.y.push_back(kEdge * at[n].y()),
        out.z.push_back(kEdge * at[n].z());
    out.nx.push_back(inward[n].x()), out.ny.push_back(inward[n].y()),
        out.nz.push_back(inward[n].z());
    out.area_m2.push_back(1e-6), out.coherence.push_back(1.0),
        out.id.push_back(static_cast<std::uint32_t>(n));
  }
  return out;
}

std::vector<Pose> path(Place place) {
  constexpr int kPoses = 64;
  std::vector<Pose> out;
  const Quat turned(Eigen::AngleAxisd(0.7, Vec3(0.2, 0.7, 0.4).normalized()));
  for (int n = 0; n < kPoses; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kPoses, round = 2.0;  // [voxels]
    Vec3 at(round * std::cos(angle), round * std::sin(angle), 0.0);
    Quat turn =
        Quat(Eigen::AngleAxisd(0.01 * std::sin(angle), Vec3(0.3, 0.5, 0.8).normalized())) * turned;
    switch (place) {
      case Place::kFar:
        at.z() += 800.0;
        break;
      case Place::kNear:
        at.z() += 0.5 * kHeight;
        break;
      case Place::kLight:
        at.z() += kFloor + kBall - 1.0;
        break;
      case Place::kHeavy:
        at = Vec3(0.0, 0.0, kFloor + kInner + 30.0 + 0.5 * round * std::cos(angle));
        turn = Quat(Eigen::AngleAxisd(0.3 + 0.01 * std::sin(angle), Vec3::UnitZ()));
        break;
    }
    out.push_back({kEdge * at, turn});
  }
  return out;
}

std::vector<Pose> eight_poses(Place place) {
  const std::vector<Pose> all = path(place);
  std::vector<Pose> out;
  for (const std::size_t n : {0U, 1U, 2U, 3U, 4U, 3U, 2U, 1U})
    out.push_back(all[n]);
  return out;
}

}  // namespace voxtouch::bench

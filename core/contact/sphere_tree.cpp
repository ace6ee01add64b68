#include "core/contact/sphere_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace voxtouch::contact {
namespace {

struct Run {
  const pointshell::Pointshell& shell;
  std::size_t begin, end;

  /// Index of the point farthest from `centre`, and its distance.
  std::size_t farthest(const Vec3& centre, double& distance) const {
    double best = -1.0;
    std::size_t point = begin;
    for (std::size_t p = begin; p < end; ++p) {
      const double squared = (shell.point(p) - centre).squaredNorm();
      if (squared > best)
        best = squared, point = p;
    }
    distance = std::sqrt(best);
    return point;
  }
};

/// Badoiu-Clarkson: from the centre of the box, step towards the farthest point by 1/(i+1), and
/// keep the best centre. Twenty steps come within a few per cent of the smallest sphere, and a
/// smaller sphere culls more.
Vec3 middle(const Run& run) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    low = low.cwiseMin(run.shell.point(p));
    high = high.cwiseMax(run.shell.point(p));
  }
  Vec3 centre = 0.5 * (low + high), best_centre = centre;
  double best = std::numeric_limits<double>::infinity();
  for (int step = 1; step <= 20; ++step) {
    double radius = 0.0;
    const std::size_t point = run.farthest(centre, radius);
    if (radius < best)
      best = radius, best_centre = centre;
    centre += (run.shell.point(point) - centre) / (step + 1.0);
  }
  return best_centre;
}

void add_sphere(const Run& run, SphereTree::Level& level) {
  const Eigen::Vector3f centre = middle(run).cast<float>();
  double radius = 0.0;
  run.farthest(centre.cast<double>(), radius);  // of the rounded centre
  level.x.push_back(centre.x()), level.y.push_back(centre.y()), level.z.push_back(centre.z());
  // Square root and conversion round, so the radius is enlarged by a few ulp to enclose the
  // farthest point for certain.
  level.radius.push_back(std::nextafter(static_cast<float>(radius * (1.0 + 1e-6)),
                                        std::numeric_limits<float>::infinity()));
  ++level.count;
}

constexpr std::size_t in_groups(std::size_t nodes) {
  return (nodes + SphereTree::kFanOut - 1) / SphereTree::kFanOut * SphereTree::kFanOut;
}

}  // namespace

SphereTree::SphereTree(const pointshell::Pointshell& shell) {
  const std::size_t end = shell.size();
  if (shell.size() > std::size_t{1} << 31)
    throw std::length_error(
        "contact: the pointshell has more than 2^31 points; use a larger voxel size");
  for (std::size_t span = kLeafPoints; levels_.empty() ? end > 0 : levels_.back().count > kFanOut;
       span *= kFanOut) {
    Level& level = levels_.emplace_back();
    for (std::size_t begin = 0; begin < end; begin += span)
      add_sphere({shell, begin, std::min(end, begin + span)}, level);
    const std::size_t filled = in_groups(level.count);
    for (std::vector<float>* const column : {&level.x, &level.y, &level.z, &level.radius})
      column->resize(filled);
  }
}

std::size_t SphereTree::bytes(std::size_t points) noexcept {
  std::size_t nodes = 0;
  for (std::size_t level = (points + kLeafPoints - 1) / kLeafPoints; level > 0;
       level = (level + kFanOut - 1) / kFanOut) {
    nodes += in_groups(level);
    if (level <= kFanOut)
      break;
  }
  return 4 * sizeof(float) * nodes;
}

}  // namespace voxtouch::contact

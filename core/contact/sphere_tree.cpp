#include "core/contact/sphere_tree.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace voxtouch {
namespace {

struct Run {
  const Pointshell& shell;
  std::size_t begin, end;

  /// Index of the point farthest from `centre`, and how far it is.
  std::size_t farthest(const Vec3& centre, double& distance) const {
    double best = -1.0;
    std::size_t point = begin;
    for (std::size_t p = begin; p < end; ++p) {
      const double squared = (shell.point(p) - centre).squaredNorm();
      if (squared > best) best = squared, point = p;
    }
    distance = std::sqrt(best);
    return point;
  }
};

/// Badoiu-Clarkson: from the box's centre, step towards the farthest point by 1/(i+1); the best centre seen is kept. Twenty
/// steps come within a few per cent of the smallest sphere, and a smaller sphere culls more.
SphereTree::Sphere enclose(const Run& run) {
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
    if (radius < best) best = radius, best_centre = centre;
    centre += (run.shell.point(point) - centre) / (step + 1.0);
  }
  // The square root rounds: a few ulp more, so that the farthest point is inside for certain.
  return {best_centre.x(), best_centre.y(), best_centre.z(), best * (1.0 + 1e-14)};
}

}  // namespace

SphereTree::SphereTree(const Pointshell& shell) {
  if (shell.size() > std::numeric_limits<std::uint32_t>::max() - kLeafPoints)
    throw std::length_error("contact: the pointshell has more than 2^32 points; use a larger voxel size");
  points_ = static_cast<std::uint32_t>(shell.size());
  if (points_ == 0) return;
  std::size_t span = kLeafPoints;
  do {
    std::vector<Sphere>& level = levels_.emplace_back();
    for (std::size_t begin = 0; begin < shell.size(); begin += span)
      level.push_back(enclose({shell, begin, std::min(shell.size(), begin + span)}));
    span *= kFanOut;
  } while (levels_.back().size() > 1);
}

}  // namespace voxtouch

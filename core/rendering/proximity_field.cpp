#include "core/rendering/proximity_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace voxtouch::rendering {
namespace {

std::int32_t stride_for(double smoothing_m, double edge) {
  return std::max(1,
                  static_cast<std::int32_t>(std::ceil(std::min(smoothing_m / edge - 1e-9, 1e4))));
}

/// The nodes of one lookup lie within 2 m sqrt(3) of each other: if their mean is below the range,
/// none is cut off.
voxmap::DistanceFieldOptions options_for(double range_m, std::int32_t stride, double edge) {
  const double voxels = std::max(2.0, range_m / edge + 3.5 * stride);
  return {.depth_voxels = voxels, .band_voxels = voxels};
}

/// Weights of three nodes at -1, 0 and 1 for a position t in [-1/2, 1/2], and their first and
/// second derivatives.
struct Spline {
  std::array<double, 3> value, slope;
  explicit Spline(double t) noexcept
      : value{0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)},
        slope{t - 0.5, -2.0 * t, t + 0.5} {}
  static constexpr std::array<double, 3> kBend = {1.0, -2.0, 1.0};
};

}  // namespace

ProximityField::ProximityField(const mesh::TriangleMesh& mesh, const voxmap::Voxmap& voxmap,
                               double range_m, double smoothing_m, const ParallelFor& parallel_for)
    : stride_(stride_for(smoothing_m, voxmap.grid().edge)),
      field_(voxmap::build_distance_field(
          mesh, voxmap, options_for(range_m, stride_, voxmap.grid().edge), parallel_for)),
      band_voxels_(static_cast<float>(
          options_for(range_m, stride_, voxmap.grid().edge).band_voxels)),  // in the precision of
                                                                            // the nodes
      reach_m_(voxmap.grid().edge * band_voxels_) {}

effects::ProximitySample ProximityField::at(const Vec3& x) const noexcept {
  effects::ProximitySample sample;
  sample.distance_m = reach_m_;
  const Vec3 u = field_.grid().to_grid(x) / stride_;
  if (!(u.cwiseAbs().sum() * stride_ < 1e9))
    return sample;  // a sum, because the maximum of NaN and a number is unspecified
  const Vec3 nearest = (u.array() + 0.5).floor();
  const Vec3 t = u - nearest;
  const Spline sx(t.x()), sy(t.y()), sz(t.z());
  const std::array first = {(static_cast<std::int32_t>(nearest.x()) - 1) * stride_,
                            (static_cast<std::int32_t>(nearest.y()) - 1) * stride_,
                            (static_cast<std::int32_t>(nearest.z()) - 1) * stride_};
  // A node that is cut off exceeds the range by more than 3 h. Its neighbours are lower by at most
  // sqrt(3) h, and so is their mean.
  if (field_.node({first[0] + stride_, first[1] + stride_, first[2] + stride_}) >= band_voxels_)
    return sample;
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
  Mat3 bend = Mat3::Zero();
  for (std::int32_t k = 0; k < 3; ++k)
    for (std::int32_t j = 0; j < 3; ++j) {
      const auto b = static_cast<std::size_t>(j), c = static_cast<std::size_t>(k);
      double d = 0.0, dx = 0.0, dxx = 0.0;  // along x
      for (std::int32_t i = 0; i < 3; ++i) {
        const auto a = static_cast<std::size_t>(i);
        const double node =
            field_.node({first[0] + i * stride_, first[1] + j * stride_, first[2] + k * stride_});
        d += sx.value[a] * node, dx += sx.slope[a] * node, dxx += Spline::kBend[a] * node;
      }
      value += sy.value[b] * sz.value[c] * d;
      gradient += Vec3(sy.value[b] * sz.value[c] * dx, sy.slope[b] * sz.value[c] * d,
                       sy.value[b] * sz.slope[c] * d);
      bend(0, 0) += sy.value[b] * sz.value[c] * dxx;
      bend(1, 1) += Spline::kBend[b] * sz.value[c] * d;
      bend(2, 2) += sy.value[b] * Spline::kBend[c] * d;
      bend(0, 1) += sy.slope[b] * sz.value[c] * dx;
      bend(0, 2) += sy.value[b] * sz.slope[c] * dx;
      bend(1, 2) += sy.slope[b] * sz.slope[c] * d;
    }
  bend(1, 0) = bend(0, 1), bend(2, 0) = bend(0, 2), bend(2, 1) = bend(1, 2);
  const double edge = field_.grid().edge;
  sample.distance_m = edge * value;
  sample.gradient = gradient / stride_;
  sample.curvature = bend / (edge * stride_ * stride_);
  return sample;
}

ToolPoints spread_tool_points(const pointshell::Pointshell& shell, std::size_t most) {
  ToolPoints out;
  std::vector<double> distance(shell.size(), std::numeric_limits<double>::infinity());  // squared
  std::vector<std::size_t> owner(shell.size(), 0);
  for (std::size_t next = 0; out.points.size() < std::min(most, shell.size());) {
    const Vec3 chosen = shell.point(next);
    for (std::size_t p = 0; p < shell.size(); ++p) {
      const double square = (shell.point(p) - chosen).squaredNorm();
      if (square < distance[p])
        distance[p] = square, owner[p] = out.points.size();
    }
    out.points.push_back({.position = chosen, .fraction = 0.0});
    out.reach_m = std::max(out.reach_m, chosen.norm());
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) -
                                    distance.begin());
    out.gap_m = std::sqrt(distance[next]);
  }
  double area = 0.0;
  for (std::size_t p = 0; p < shell.size(); ++p) {
    out.points[owner[p]].fraction += shell.area_m2[p];
    area += shell.area_m2[p];
  }
  for (effects::ToolPoint& point : out.points)
    point.fraction =
        area > 0.0 ? point.fraction / area : 1.0 / static_cast<double>(out.points.size());
  return out;
}

}  // namespace voxtouch::rendering

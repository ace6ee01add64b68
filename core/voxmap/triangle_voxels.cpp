#include "core/voxmap/triangle_voxels.hpp"

#include <algorithm>
#include <cmath>

#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr double kFilter = 64.0 * 0x1p-53;  // more than the sum of the roundings of any form
constexpr int kPlane = 16;

}  // namespace

TriangleVoxels::TriangleVoxels(const Vec3& a, const Vec3& b, const Vec3& c) noexcept
    : corner_{a, b, c} {
  bool on_border = false;
  int wide = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::min({a[axis], b[axis], c[axis]}),
                 high = std::max({a[axis], b[axis], c[axis]});
    const auto s = static_cast<std::size_t>(axis);
    first_[s] = static_cast<std::int32_t>(std::ceil(low) - 1.0);
    last_[s] = static_cast<std::int32_t>(std::floor(high));
    on_border = on_border || low == std::floor(low) || high == std::floor(high);
    wide += last_[s] > first_[s];
  }
  // A connected set that extends over several layers along one axis only meets the open cube of
  // each of them.
  boxed_ = !on_border && wide <= 1;
  if (boxed_)
    return;
  normal_ = area_vector(a, b, c);
  // runs are long along the axis most parallel to the triangle
  run_ = std::abs(normal_.y()) < std::abs(normal_.z()) ? 1 : 2;
  for (int dropped = 0; dropped < 3; ++dropped)
    add_edge_forms(dropped);
  if (!normal_.isZero(0.0))
    add_plane_forms();
}

void TriangleVoxels::add(int kind, double side, const std::array<double, 3>& gradient,
                         double at_zero, double magnitude) noexcept {
  Form& form = form_[static_cast<std::size_t>(forms_++)];
  form.kind = side > 0.0 ? kind : -1 - kind;
  form.constant = side * at_zero;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    form.slope[axis] = side * gradient[axis];
    // The innermost corner of the cube decides: the positive slopes are added once again.
    if (form.slope[axis] > 0.0)
      form.constant += form.slope[axis];
  }
  form.error = kFilter * magnitude;
}

/// Projection of the cube along one axis against that of the triangle: one form for each edge, on
/// the side of the third corner. A projection of zero area has edges in both directions along one
/// line, which bound it from both sides. Edges projected to a point give no bound.
void TriangleVoxels::add_edge_forms(int dropped) noexcept {
  const int p = (dropped + 1) % 3, q = (dropped + 2) % 3;
  const auto sp = static_cast<std::size_t>(p), sq = static_cast<std::size_t>(q);
  const double width_p = last_[sp] - first_[sp] + 2.0, width_q = last_[sq] - first_[sq] + 2.0;
  for (int edge = 0; edge < 3; ++edge) {
    const Vec3& a = corner_[static_cast<std::size_t>(edge)];
    const Vec3& b = corner_[static_cast<std::size_t>((edge + 1) % 3)];
    const double fp = b[p] - a[p], fq = b[q] - a[q];
    if (fp == 0.0 && fq == 0.0)
      continue;
    std::array<double, 3> gradient{};
    gradient[sp] = -fq;
    gradient[sq] = fp;
    const double at_first = fp * (first_[sq] - a[q]) - fq * (first_[sp] - a[p]);
    const double magnitude = std::abs(fp) * width_q + std::abs(fq) * width_p;
    const int kind = 4 * dropped + edge;
    const double seen = normal_[dropped];  // orientation of the projection; its sign is exact
    add(kind, seen >= 0.0 ? 1.0 : -1.0, gradient, at_first, magnitude);
  }
}

void TriangleVoxels::add_plane_forms() noexcept {
  const Vec3 side = (corner_[1] - corner_[0]).cwiseAbs(),
             other = (corner_[2] - corner_[0]).cwiseAbs();
  std::array<double, 3> gradient{};
  double at_first = 0.0, magnitude = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    const auto s = static_cast<std::size_t>(axis);
    gradient[s] = normal_[axis];
    at_first += normal_[axis] * (first_[s] - corner_[0][axis]);
    // `area_vector` guarantees a component to 2^-37 relative; the products are the terms of that
    // error.
    magnitude += (side[p] * other[q] + side[q] * other[p] + std::abs(normal_[axis]) * 0x1p10) *
                 (last_[s] - first_[s] + 2.0);
  }
  add(kPlane, 1.0, gradient, at_first, magnitude);
  add(kPlane, -1.0, gradient, at_first, magnitude);
}

double TriangleVoxels::exact_value(const Form& form, const VoxelIndex& v) const noexcept {
  const int kind = form.kind < 0 ? -1 - form.kind : form.kind;
  const double side = form.kind < 0 ? -1.0 : 1.0;
  const Vec3 base(v.i, v.j, v.k);
  Vec3 x = base;
  for (int axis = 0; axis < 3; ++axis)
    if (form.slope[static_cast<std::size_t>(axis)] > 0.0)
      x[axis] += 1.0;
  if (kind == kPlane)
    return side * orient3d(corner_[0], corner_[1], corner_[2], x);
  const int p = (kind / 4 + 1) % 3, q = (kind / 4 + 2) % 3;
  const Vec3& a = corner_[static_cast<std::size_t>(kind % 4)];
  const Vec3& b = corner_[static_cast<std::size_t>((kind % 4 + 1) % 3)];
  return side * orient2d(a[p], a[q], b[p], b[q], x[p], x[q]);
}

Meeting TriangleVoxels::meeting(const VoxelIndex& v) const noexcept {
  const std::array<std::int32_t, 3> at{v.i, v.j, v.k};
  bool touch = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] < first_[axis] || at[axis] > last_[axis])
      return Meeting::kNone;
    const auto a = static_cast<Eigen::Index>(axis);
    touch = touch || std::min({corner_[0][a], corner_[1][a], corner_[2][a]}) >= at[axis] + 1.0 ||
            std::max({corner_[0][a], corner_[1][a], corner_[2][a]}) <= at[axis];
  }
  if (boxed_)
    return Meeting::kOpen;
  const double x = double(v.i) - first_[0], y = double(v.j) - first_[1],
               z = double(v.k) - first_[2];
  for (int n = 0; n < forms_; ++n) {
    const Form& form = form_[static_cast<std::size_t>(n)];
    double value = form.slope[0] * x + form.slope[1] * y + form.slope[2] * z + form.constant;
    if (value > form.error)
      continue;
    if (value >= -form.error)
      value = exact_value(form, v);
    if (value < 0.0)
      return Meeting::kNone;
    touch = touch || value == 0.0;
  }
  return touch ? Meeting::kTouch : Meeting::kOpen;
}

TriangleVoxels::Range TriangleVoxels::rows_in_slab(std::int32_t i) const noexcept {
  const int axis = 3 - run_;
  double low = INFINITY, high = -INFINITY;
  const auto extend = [&](double value) {
    low = std::min(low, value), high = std::max(high, value);
  };
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3& a = corner_[n];
    const Vec3& b = corner_[(n + 1) % 3];
    if (a.x() >= i && a.x() <= i + 1.0)
      extend(a[axis]);
    for (int border = 0; border < 2; ++border) {
      const double x = i + double(border);
      if ((a.x() < x && b.x() > x) || (a.x() > x && b.x() < x))
        extend(a[axis] + (b[axis] - a[axis]) * std::clamp((x - a.x()) / (b.x() - a.x()), 0.0, 1.0));
    }
  }
  const auto s = static_cast<std::size_t>(axis);
  const double slack =
      1e-9 * (last_[s] - first_[s] + 2.0) + 1e-15 * std::max(std::abs(low), std::abs(high));
  return {std::max(first_[s], static_cast<std::int32_t>(std::ceil(low - slack) - 1.0)),
          std::min(last_[s], static_cast<std::int32_t>(std::floor(high + slack)))};
}

bool TriangleVoxels::solve_row(std::int32_t i, std::int32_t row, Range& run) const noexcept {
  const auto row_axis = static_cast<std::size_t>(3 - run_),
             run_axis = static_cast<std::size_t>(run_);
  const double x = double(i) - first_[0], y = double(row) - first_[row_axis];
  const double length = double(last_[run_axis]) - first_[run_axis];
  double low = 0.0, high = length;
  bool certain = true;
  for (int n = 0; n < forms_; ++n) {
    const Form& form = form_[static_cast<std::size_t>(n)];
    const double rest = form.slope[0] * x + form.slope[row_axis] * y + form.constant;
    const double slope = form.slope[run_axis];
    const double least = slope < 0.0 ? rest + slope * high : rest + slope * low;
    const double most = slope < 0.0 ? rest + slope * low : rest + slope * high;
    if (least > form.error)
      continue;  // the whole run passes
    if (most < -form.error)
      return false;
    if (slope > 0.0) {
      const double from = (-rest - form.error) / slope, sure = (-rest + form.error) / slope;
      low = std::max(low, std::ceil(from - 1e-12 * std::abs(from)));
      certain = certain && low >= sure + 1e-12 * std::abs(sure);
    } else if (slope < 0.0) {
      const double to = (rest + form.error) / -slope, sure = (rest - form.error) / -slope;
      high = std::min(high, std::floor(to + 1e-12 * std::abs(to)));
      certain = certain && high <= sure - 1e-12 * std::abs(sure);
    } else {
      certain = false;
    }
    if (low > high)
      return false;
  }
  run = {first_[run_axis] + static_cast<std::int32_t>(low),
         first_[run_axis] + static_cast<std::int32_t>(high)};
  if (certain)
    return true;
  while (run.first <= run.last && meeting(voxel(i, row, run.first)) == Meeting::kNone)
    ++run.first;
  while (run.last > run.first && meeting(voxel(i, row, run.last)) == Meeting::kNone)
    --run.last;
  return run.first <= run.last;
}

}  // namespace voxtouch::voxmap

#include "core/contact/hit_list.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace voxtouch::contact {

Hit HitSource::hit(std::uint32_t point) const noexcept {
  Hit out;
  out.point = point;
  const Vec3 at(place[0][point], place[1][point], place[2][point]);
  const Vec3 inward(normal[0][point], normal[1][point], normal[2][point]);
  for (int row = 0; row < 3; ++row) {
    const double x = r[row][0] * at.x(), y = r[row][1] * at.y(), z = r[row][2] * at.z();
    const double u = (x + y + z + t[row]) / edge;
    const auto which = static_cast<std::size_t>(row);
    out.arm[row] = row_sum(which, x, y, z);
    out.normal[row] =
        row_sum(which, r[row][0] * inward.x(), r[row][1] * inward.y(), r[row][2] * inward.z());
    // Centre minus point within the voxel: the grid's own origin, perhaps 1e6 m away, is not
    // involved.
    out.to_centre[row] = edge * ((std::floor(u) + 0.5) - u);
  }
  out.weight = area != nullptr ? area[point] : 1.0;
  return out;
}

std::size_t Hits::not_below(std::uint32_t point, std::size_t from) const noexcept {
  std::size_t step = 1, low = from;
  while (low + step < size() && points_[low + step] < point)
    low += step, step *= 2;
  const auto place = std::lower_bound(
      points_.begin() + static_cast<std::ptrdiff_t>(std::min(low, size())),
      points_.begin() + static_cast<std::ptrdiff_t>(std::min(low + step + 1, size())), point);
  return static_cast<std::size_t>(place - points_.begin());
}

std::size_t Hits::find(std::uint32_t point, std::size_t from) const noexcept {
  const std::size_t n = not_below(point, from);
  return n < size() && points_[n] == point ? n : size();
}

std::uint32_t* Hits::room(std::size_t count) {
  points_.resize(count + kSpareRoom);
  return points_.data();
}

void Hits::keep(std::size_t found, const HitSource& source) {
  points_.resize(found);
  source_ = source;
}

void Hits::merge(const Hits& other) noexcept {
  if (empty())
    source_ = other.source_;
  merge_ascending(other.points_, points_, std::less<>());
}

void Hits::clear() noexcept {
  points_.clear();
  normal_sum_.setZero();
  weight_sum_ = 0.0;
}

}  // namespace voxtouch::contact

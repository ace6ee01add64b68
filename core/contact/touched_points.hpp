#pragma once
/// The points that touched in the last look-up of a ring: what a look-up that may not test all
/// points must not lose.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/hit_list.hpp"

namespace voxtouch::contact {

/// Numbers of points, ascending. All memory is taken at construction; everything else is real-time
/// safe.
class TouchedPoints {
 public:
  explicit TouchedPoints(std::size_t points) : marks_(points, 0) {
    surface_.reserve(points), interior_.reserve(points);
  }

  void take(const HitList& hits) noexcept {
    if (++now_ == 0)
      std::fill(marks_.begin(), marks_.end(), 0), now_ = 1;
    take(hits.surface, surface_);
    take(hits.interior, interior_);
  }
  void clear() noexcept { take({}); }

  bool has(std::uint32_t point) const noexcept { return marks_[point] == now_; }
  std::span<const std::uint32_t> surface() const noexcept { return surface_; }
  std::span<const std::uint32_t> interior() const noexcept { return interior_; }

 private:
  void take(const Hits& hits, std::vector<std::uint32_t>& points) noexcept {
    points.assign(hits.points(), hits.points() + hits.size());
    for (const std::uint32_t point : points)
      marks_[point] = now_;
  }

  std::vector<std::uint32_t> surface_, interior_;
  std::vector<std::uint32_t> marks_;  ///< of each point, the take that it touched in last
  std::uint32_t now_ = 1;
};

}  // namespace voxtouch::contact

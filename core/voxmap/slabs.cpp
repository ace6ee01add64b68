#include "core/voxmap/slabs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace voxtouch::voxmap {

Slabs::Slabs(const GridMesh& mesh, std::int32_t base, std::size_t count)
    : base_(base),
      start_(count + 1, 0) {
  const auto range = [&](std::size_t t) {
    const auto [low, high] =
        std::minmax({mesh.corner(t, 0).x(), mesh.corner(t, 1).x(), mesh.corner(t, 2).x()});
    const auto slab = [&](double i) {
      return static_cast<std::size_t>(std::clamp((static_cast<std::int64_t>(i) - base) >> 3,
                                                 std::int64_t{0},
                                                 static_cast<std::int64_t>(count) - 1));
    };
    return std::pair{slab(std::ceil(low) - 1.0), slab(std::floor(high))};
  };
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const auto [from, to] = range(t);
    for (std::size_t s = from; s <= to; ++s)
      ++start_[s + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  triangles_.resize(start_.back());
  std::vector<std::size_t> fill(start_.begin(), start_.end() - 1);
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const auto [from, to] = range(t);
    for (std::size_t s = from; s <= to; ++s)
      triangles_[fill[s]++] = static_cast<std::uint32_t>(t);
  }
}

}  // namespace voxtouch::voxmap

#include "core/accuracy/true_forces.hpp"

#include <algorithm>

#include "core/accuracy/contact_errors.hpp"

namespace voxtouch::accuracy {
namespace {
constexpr double kFaintRatio = 0.05;  ///< of the median true force
}  // namespace

std::vector<Wrench> TrueForces::at(const std::vector<ContactPlace>& places, std::size_t count,
                                   double depth_m,
                                   const std::function<void(double fraction)>& progress) {
  std::vector<Wrench>& known = known_[depth_m];
  const std::size_t requested = std::min(count, places.size()), before = known.size();
  while (known.size() < requested) {
    if (progress)
      progress(static_cast<double>(known.size() - before) /
               static_cast<double>(requested - before));
    known.push_back(reference_.at(places[known.size()].at(depth_m), depth_m).wrench);
  }
  std::vector<Wrench> out(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(requested));
  std::vector<double> sizes;
  for (const Wrench& w : out)
    sizes.push_back(w.force.norm());
  const double faint = kFaintRatio * median_of(sizes);
  for (Wrench& w : out)
    if (!(w.force.norm() > faint))
      w = {};
  return out;
}

std::size_t TrueForces::unknown(const std::vector<ContactPlace>& places, std::size_t count,
                                double depth_m) const {
  const auto known = known_.find(depth_m);
  const std::size_t requested = std::min(count, places.size()),
                    has = known == known_.end() ? 0 : known->second.size();
  return requested > has ? requested - has : 0;
}

}  // namespace voxtouch::accuracy

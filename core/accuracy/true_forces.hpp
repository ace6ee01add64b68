#pragma once
/// The true wrenches at the places of a measurement, each worked out once.
#include <functional>
#include <map>
#include <vector>

#include "core/accuracy/contact_places.hpp"
#include "core/reference/reference_wrench.hpp"

namespace voxtouch::accuracy {

/// Of the penalty law, per unit of its stiffness (ReferenceWrench at a resolution of the depth
/// itself).
class TrueForces {
 public:
  explicit TrueForces(const scene::Scene& scene) : reference_(scene, scene.voxel_size_m) {}

  /// Forces at the first `count` of `places`, `depth_m` in; zero if the contact is so small that
  /// rounding dominates. The same places in every call. `progress` receives the fraction of new
  /// ones.
  std::vector<Wrench> at(const std::vector<ContactPlace>& places, std::size_t count, double depth_m,
                         const std::function<void(double fraction)>& progress = {});
  /// How many of these have not been worked out yet.
  std::size_t unknown(const std::vector<ContactPlace>& places, std::size_t count,
                      double depth_m) const;

 private:
  reference::ReferenceWrench reference_;
  std::map<double, std::vector<Wrench>> known_;  ///< by depth: of the first places
};

}  // namespace voxtouch::accuracy

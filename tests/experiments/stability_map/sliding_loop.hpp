#pragma once
/// What a contact model gives to a hand that slides a ball round a closed loop over a plane.
#include <cstdint>

#include "core/contact/contact_renderer.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::sliding {

/// One setting of the map.
struct Setting {
  contact::ContactModelKind model = contact::ContactModelKind::kAdapted;
  double radius_voxels = 10.0;  ///< of the ball: its radius over the voxel edge
  double depth_voxels = 0.5;    ///< of the ball below the plane
  double tilt_deg = 0.0;        ///< of the plane against the grid, about (2, 1, 0)
};

/// Of the worst of several loops: circles of a fifth of the ball's radius, but at least three
/// voxels, at random places, both ways round.
struct Created {
  double fraction =
      0.0;  ///< energy that the hand is given over (mean force times the length of the way)
  double per_crossing =
      0.0;  ///< the same over k e^2 times the weights of the points that crossed a voxel border
  double mean_force_n = 0.0;  ///< for k = 1 N/mm^3, a ball of 10 mm
  double largest_step = 0.0;  ///< of the force between two poses 0.05 e apart, over the mean force
};

/// The ball and the plane of one voxel size and tilt; the models are looked at in turn.
class Bench {
 public:
  Bench(double radius_voxels, double tilt_deg);
  /// `loops` drawn from `seed`, each walked both ways through the ring's stage, memory included.
  Created worst_loop(contact::ContactModelKind model, double depth_voxels, int loops,
                     std::uint64_t seed) const;

  static constexpr double kRadiusM = 0.01;
  static constexpr double kPressure = 1e9;  ///< k [N/m^3]

  contact::ContactRenderer renderer(contact::ContactModelKind model) const;
  /// The ball's origin in W for a place on the plane [m], `depth_m` deep.
  Pose at(double x, double y, double depth_m) const;
  double edge_m() const noexcept { return edge_; }
  Vec3 normal() const { return turn_ * Vec3::UnitZ(); }

 private:
  double edge_;
  Quat turn_;
  pointshell::Pointshell shell_;
  voxmap::Voxmap voxmap_;
  voxmap::DistanceField field_;
};

}  // namespace voxtouch::sliding

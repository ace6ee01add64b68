#pragma once
/// An arm as a chain of revolute joints, for visualisation: the robot description of ROS.
#include <string>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::arm {

struct ArmJoint {
  std::string_view name;
  /// Of the joint's link in that of the previous link, at an angle of 0; it rotates about its own
  /// z.
  Pose origin;
  double low_rad = 0.0, high_rad = 0.0, velocity_rad_s = 0.0, torque_nm = 0.0;  ///< limits
};

struct ArmDescription {
  std::string_view model;        ///< "lwr"
  std::vector<ArmJoint> joints;  ///< from the base B on, in the order of the driver's numbers
  Pose flange;                   ///< in the last joint's link
  double link_radius_m = 0.04;   ///< for drawing the links
};

/// The arm in URDF, with links <model>_base, <model>_link1 and so on, <model>_flange. Each link is
/// drawn as a cylinder to the next.
std::string to_urdf(const ArmDescription& arm);

}  // namespace voxtouch::arm

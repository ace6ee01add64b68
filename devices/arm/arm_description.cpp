#include "devices/arm/arm_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace voxtouch::arm {
namespace {

/// Replaces rounding residues of 0 by 0.
double clean(double x) { return std::abs(x) < 1e-12 ? 0.0 : x; }

std::string origin(const Pose& pose) {
  const Mat3 r = pose.orientation.normalized().toRotationMatrix();
  const Vec3 rpy(std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
                 std::atan2(r(1, 0), r(0, 0)));
  const Vec3& p = pose.position;
  return fmt::format("<origin xyz=\"{:.10g} {:.10g} {:.10g}\" rpy=\"{:.10g} {:.10g} {:.10g}\"/>",
                     clean(p.x()), clean(p.y()), clean(p.z()), clean(rpy.x()), clean(rpy.y()),
                     clean(rpy.z()));
}

/// A link that extends to `next`, in its own frame.
std::string link(const std::string& name, const Vec3& next, double radius_m) {
  const double length = next.norm();
  if (!(length > 1e-6))
    return fmt::format("  <link name=\"{}\"/>\n", name);
  const Pose middle{next / 2.0, Quat::FromTwoVectors(Vec3::UnitZ(), next)};
  return fmt::format(
      "  <link name=\"{}\">\n    <visual>\n      {}\n      <geometry><cylinder radius=\"{}\" "
      "length=\"{:.10g}\"/></geometry>\n    </visual>\n  </link>\n",
      name, origin(middle), radius_m, length);
}

}  // namespace

std::string to_urdf(const ArmDescription& arm) {
  const auto name_of = [&](std::size_t n) {
    return n == 0 ? fmt::format("{}_base", arm.model) : fmt::format("{}_link{}", arm.model, n);
  };
  const auto reach = [&](std::size_t n) {
    return n < arm.joints.size() ? arm.joints[n].origin.position : arm.flange.position;
  };
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", arm.model);
  for (std::size_t n = 0; n <= arm.joints.size(); ++n)
    text += link(name_of(n), reach(n), arm.link_radius_m);
  text += link(fmt::format("{}_flange", arm.model), Vec3::Zero(), arm.link_radius_m);
  for (std::size_t n = 0; n < arm.joints.size(); ++n) {
    const ArmJoint& joint = arm.joints[n];
    text += fmt::format(
        "  <joint name=\"{}\" type=\"revolute\">\n    <parent link=\"{}\"/>\n    <child "
        "link=\"{}\"/>\n    {}\n    <axis xyz=\"0 0 1\"/>\n"
        "    <limit lower=\"{:.10g}\" upper=\"{:.10g}\" velocity=\"{:.10g}\" "
        "effort=\"{:.10g}\"/>\n  </joint>\n",
        joint.name, name_of(n), name_of(n + 1), origin(joint.origin), joint.low_rad, joint.high_rad,
        joint.velocity_rad_s, joint.torque_nm);
  }
  text += fmt::format(
      "  <joint name=\"{0}_flange_joint\" type=\"fixed\">\n    <parent link=\"{1}\"/>\n    <child "
      "link=\"{0}_flange\"/>\n    {2}\n  </joint>\n</robot>\n",
      arm.model, name_of(arm.joints.size()), origin(arm.flange));
  return text;
}

}  // namespace voxtouch::arm

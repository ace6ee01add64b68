#pragma once
/// The paper's sphere over planes and cylinders, through every contact model.
#include <functional>
#include <string>
#include <vector>

#include "core/contact/contact_renderer.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::paper {

inline constexpr double kEdge = 2e-3;          ///< voxel edge e [m]
inline constexpr double kRadius = 10 * kEdge;  ///< of the sphere: R / e = 10

/// A static mesh with the data of all contact models.
struct Ground {
  voxmap::Voxmap voxmap;
  voxmap::DistanceField field;
  explicit Ground(const mesh::TriangleMesh& mesh);
};

/// The sphere's two shells; its centre is the tool's origin.
struct Sphere {
  mesh::TriangleMesh mesh;
  pointshell::Pointshell exact, naive;
  /// `grid_shift` moves the voxel grid that the shells are made on, in edges.
  explicit Sphere(const Vec3& grid_shift = Vec3(0.13, 0.37, 0.41));
};

/// One column of a table: the compared case.
struct ContactCase {
  std::string name;
  contact::ContactModelKind model = contact::ContactModelKind::kAdapted;
  contact::PointWeights weights = contact::PointWeights::kOne;
  bool naive = false;
};
/// original, adapted, both by area, field; all with the exact shell.
std::vector<ContactCase> all_contact_cases();
contact::ContactRenderer renderer_of(const ContactCase& contact_case, const Ground& ground,
                                     const Sphere& sphere);

/// A path on which the sphere keeps its depth: its centre, and the surface's normal there. `s` from
/// 0 to 1.
struct Slide {
  std::string name;
  mesh::TriangleMesh mesh;
  std::function<Vec3(double s)> centre, normal;
  Quat turn = Quat::Identity();  ///< of the sphere
};
/// A circle of ten edges over a plane that is rotated by `turn`; `up_its_voxel` in [0, 1): position
/// of an aligned face.
Slide circle_on_plane(const std::string& name, const Quat& turn, double up_its_voxel,
                      double depth_edges, const Quat& ball);
/// Round a cylinder about the z axis.
Slide round_a_cylinder(double radius_m, double depth_edges, const Quat& ball, double along_m);

/// Force across the normal at `steps` poses of a slide, and its noise.
struct Distraction {
  std::vector<Vec3> across;   ///< [k e^3 or K e: as the contact model's unit], W
  std::vector<double> along;  ///< force along the normal
  double mean = 0.0;          ///< of `along`
  double rms = 0.0;           ///< of |across|, over the mean
  double rms_about_mean =
      0.0;             ///< the same without its mean (in the frame that rotates with the normal)
  double noise = 0.0;  ///< standard deviation of `along` over its mean
};
Distraction distraction(contact::ContactRenderer renderer, const Slide& slide, int steps);

}  // namespace voxtouch::paper

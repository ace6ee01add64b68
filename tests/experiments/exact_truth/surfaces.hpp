#pragma once
/// Surfaces on which the virtual tool is compared with the reference.
#include <random>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::exact_truth {

/// A closed mesh. Places are drawn from its triangles by area.
struct Surface {
  std::string name;
  mesh::TriangleMesh mesh;
  double keep_m = 0.0;  ///< places are on the side walls or the top, this far from their rims
};

/// "plane", "cylinder" (5,000 triangles), "fine_cylinder" (500,000), "cup".
/// Throws std::invalid_argument for another name.
Surface surface(const std::string& name);

/// A point of the surface and its outward normal.
struct Spot {
  Vec3 point, normal;
};
Spot random_spot(const Surface& surface, std::mt19937_64& random);

/// Uniform between 0 and 1, the same with every standard library.
double uniform(std::mt19937_64& random);
/// Uniform over all rotations.
Quat random_rotation(std::mt19937_64& random);

}  // namespace voxtouch::exact_truth

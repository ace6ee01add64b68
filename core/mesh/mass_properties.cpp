#include "core/mesh/mass_properties.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace voxtouch::mesh {

MassProperties mass_properties(const TriangleMesh& mesh) {
  if (mesh.vertices.empty())
    throw std::invalid_argument("the mesh is empty, so it has no mass");
  Vec3 middle = Vec3::Zero();  // computes near the mesh, to keep digits far from the origin
  for (const Vec3& v : mesh.vertices)
    middle += v / static_cast<double>(mesh.vertices.size());
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();  // integral of x x'
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - middle, b = mesh.vertices[t[1]] - middle,
               c = mesh.vertices[t[2]] - middle;
    const double six = a.dot(b.cross(c));  // six times the tetrahedron's signed volume
    const Vec3 sum = a + b + c;
    volume += six / 6.0;
    first += (six / 24.0) * sum;
    second += (six / 120.0) *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  double size = 0.0;
  for (const Vec3& v : mesh.vertices)
    size = std::max(size, (v - middle).norm());
  if (!(std::abs(volume) > 1e-9 * size * size * size))
    throw std::invalid_argument("the mesh encloses no volume (open or flat), so it has no mass");
  MassProperties out;
  out.volume_m3 = std::abs(volume);
  const Vec3 centre = first / volume;
  const Mat3 spread = second / volume - centre * centre.transpose();
  out.centre = middle + centre;
  out.inertia_m2 = spread.trace() * Mat3::Identity() - spread;
  if (!(Eigen::SelfAdjointEigenSolver<Mat3>(out.inertia_m2).eigenvalues().minCoeff() > 0.0))
    throw std::invalid_argument(
        "parts of the mesh have opposite orientations: its mass is undefined");
  return out;
}

}  // namespace voxtouch::mesh

#include "core/reference/mesh_distance.hpp"

#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <cmath>

#include "core/reference/fcl_mesh.hpp"

namespace voxtouch::reference {
namespace {

/// Size of the second method's triangle relative to the mesh.
constexpr double kProbeRatio = 1e-9;
constexpr double kRoundingRatio = 1e-9;  ///< rounding of FCL's projections relative to the mesh

/// Lengths in FCL over metres. FCL takes triangles for degenerate by an absolute limit (squared
/// normal below 1e-15) and then reports that they meet: in metres, those with edges of 0.1 mm.
/// A power of two: rounding stays the same.
constexpr double kUnitsPerM = 1024.0;

double size_of(const ReferenceMesh& mesh) {
  double size = 0.0;
  for (const Vec3& v : mesh.vertices)
    size = std::max(size, (v - mesh.vertices.front()).norm());
  return size;
}

ReferenceMesh probe_triangle(double size) {
  ReferenceMesh mesh;
  mesh.vertices = {size * Vec3(1, 0, 0), size * Vec3(-0.5, 0.8, 0.1),
                   size * Vec3(-0.5, -0.8, -0.1)};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

std::unique_ptr<FclMesh> in_units(ReferenceMesh mesh) {
  for (Vec3& v : mesh.vertices)
    v *= kUnitsPerM;
  return make_fcl_mesh(mesh);
}

fcl::Transform3d at(const Vec3& x) {
  fcl::Transform3d pose = fcl::Transform3d::Identity();
  pose.translation() = kUnitsPerM * x;
  return pose;
}

}  // namespace

struct MeshDistance::Model {
  double size;
  std::unique_ptr<FclMesh> bvh, probe;
};

MeshDistance::MeshDistance(const ReferenceMesh& mesh) : model_(std::make_unique<Model>()) {
  model_->size = size_of(mesh);
  model_->bvh = in_units(mesh);
  model_->probe = in_units(probe_triangle(kProbeRatio * model_->size));
}
MeshDistance::~MeshDistance() = default;
MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;

double MeshDistance::second_method_error_m() const noexcept {
  return (kProbeRatio + kRoundingRatio) * model_->size;
}

NearestPoint MeshDistance::nearest(const Vec3& x) const {
  const fcl::DistanceRequestd request(true);
  fcl::DistanceResultd result;
  const fcl::Sphered point(0.0);
  fcl::distance(model_->bvh.get(), fcl::Transform3d::Identity(), &point, at(x), request, result);
  const Vec3 found = result.nearest_points[0] / kUnitsPerM;
  const double length = (x - found).norm();
  if (std::isfinite(length) && std::abs(length - result.min_distance / kUnitsPerM) <=
                                   kRoundingRatio * (model_->size + length))
    return {length, found};
  return {second_method(x), x};
}

double MeshDistance::second_method(const Vec3& x) const {
  const fcl::DistanceRequestd request(true);
  fcl::DistanceResultd result;
  fcl::distance(model_->bvh.get(), fcl::Transform3d::Identity(), model_->probe.get(), at(x),
                request, result);
  return std::max(0.0, result.min_distance / kUnitsPerM);
}

NearestPair MeshDistance::to(const MeshDistance& other, const Pose& other_in_mine) const {
  const fcl::DistanceRequestd request(true);
  fcl::DistanceResultd result;
  fcl::Transform3d pose = at(other_in_mine.position);
  pose.linear() = other_in_mine.orientation.toRotationMatrix();
  fcl::distance(model_->bvh.get(), fcl::Transform3d::Identity(), other.model_->bvh.get(), pose,
                request, result);
  if (!(result.min_distance > 0))
    return {};
  return {result.min_distance / kUnitsPerM, result.nearest_points[0] / kUnitsPerM,
          result.nearest_points[1] / kUnitsPerM};
}

}  // namespace voxtouch::reference

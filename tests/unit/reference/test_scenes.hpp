#pragma once
/// Scenes over the meshes of tests/data/vectors, and temporary mesh files.
#include <filesystem>
#include <fstream>
#include <string>

#include "core/scene/scene.hpp"

namespace voxtouch::test_scenes {

inline constexpr double kEdge = 0.05;         ///< voxel edge of these scenes [m]
inline constexpr double kSphereRadius = 0.5;  ///< sphere.obj (R = 0.75) at scale 2/3: ten edges

inline scene::MeshSpec mesh(const std::string& name, double scale = 1.0) {
  scene::MeshSpec spec;
  spec.path = std::filesystem::path(VOXTOUCH_TEST_DATA) / "vectors/meshes" / name;
  spec.scale = scale;
  return spec;
}

/// The sphere with its centre at the tool's origin.
inline scene::MeshSpec sphere(double radius = kSphereRadius) {
  scene::MeshSpec spec = mesh("sphere.obj", radius / 0.75);
  const Vec3 centre = spec.scale * Vec3(0.012939453125, -0.02099609375, 0.033935546875);
  spec.primitives = {scene::SpherePrimitive{centre, radius}};
  spec.pose.position = -centre;
  return spec;
}

inline const Vec3 kCylinderCentre(0.030029296875, 0.010009765625, -0.02001953125);
inline scene::CylinderPrimitive cylinder_primitive() {
  return {{kCylinderCentre, Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitY())}, 0.5, 1.5};
}
inline scene::BoxPrimitive box_primitive() { return {{}, Vec3(0.75, 0.5, 0.5)}; }

inline scene::Scene scene(scene::MeshSpec fixed, scene::MeshSpec moving = sphere()) {
  scene::Scene out;
  out.voxel_size_m = kEdge;
  out.static_meshes = {std::move(fixed)};
  out.dynamic_mesh = std::move(moving);
  return out;
}

inline Pose at(const Vec3& position) { return {position, Quat::Identity()}; }

/// A temporary mesh file. Its name includes the test's, so that tests may run in parallel.
class TemporaryMesh {
 public:
  TemporaryMesh(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() / name) {
    std::ofstream(path_) << text;
  }
  ~TemporaryMesh() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryMesh(const TemporaryMesh&) = delete;
  TemporaryMesh& operator=(const TemporaryMesh&) = delete;
  scene::MeshSpec spec() const {
    scene::MeshSpec out;
    out.path = path_;
    return out;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace voxtouch::test_scenes

#pragma once
/// A ground and a tool in general position, touched with every contact model; coordinates short
/// enough to be moved exactly.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/contact/contact_renderer.hpp"
#include "core/mesh/triangle_mesh.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::hard {

inline constexpr double kEdge = 0x1p-9;  ///< voxel edge of these scenes, about 2 mm
inline constexpr double kStep =
    0x1p-18;  ///< vertices are integer multiples of it, so that midpoints are exact
inline constexpr double kPerPoint = 128.0;    ///< [N/m]
inline constexpr double kPerVolume = 0x1p29;  ///< [N/m^3]
inline constexpr double kBallRadius = 0.0085;

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high);
Quat any_rotation(Random& random);
/// Rounded to whole multiples of `step`.
Vec3 stepped(const Vec3& x, double step);

/// A tilted box with a ball that overlaps it; closed parts.
mesh::TriangleMesh ground_mesh();
/// A ball that lies askew about a point next to its origin.
mesh::TriangleMesh tool_mesh();

/// The voxels that are not free, sorted, with their kind.
std::vector<std::pair<voxmap::VoxelIndex, voxmap::VoxelKind>> voxels_of(
    const voxmap::Voxmap& voxmap);

/// Results at one pose, by model (index 0 is `original`).
inline constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                       contact::ContactModelKind::kAdapted,
                                       contact::ContactModelKind::kField};
inline constexpr std::size_t kField = 2;  ///< its index
using Answers = std::array<contact::ContactResult, kModels.size()>;

/// Ground, tool and their models; `with_field` false for grounds without an inside.
struct Rig {
  voxmap::Voxmap voxmap;
  voxmap::DistanceField field;
  pointshell::Pointshell shell;
  std::array<std::unique_ptr<contact::ContactRenderer>, kModels.size()>
      models;    ///< null: the ground allows no field
  double scale;  ///< of all lengths; stiffnesses stay, voxels and steps grow with it

  Rig(const mesh::TriangleMesh& ground, const voxmap::Grid& grid, pointshell::Pointshell tool,
      const ParallelFor& loop = serial_for());
  Rig(const mesh::TriangleMesh& ground, const mesh::TriangleMesh& tool, double edge = kEdge,
      const ParallelFor& loop = serial_for());

  /// Without memory, all models; zero results for missing models.
  Answers probe(const Pose& pose) const;

 private:
  void make_models();
};

/// Poses of the ball in light contact with the mesh: from half a voxel above to one and a half
/// deep. Positions are integer multiples of 2^-26 m, so that they can be displaced exactly.
std::vector<Pose> touching_poses(const mesh::TriangleMesh& ground, std::size_t count,
                                 Random& random);

/// K times the weights of all hits, summed: by how much a force changes if each depth changes by a
/// metre.
double pull(const Rig& rig, const Pose& pose, std::size_t model);

bool same_bits(const contact::ContactResult& a, const contact::ContactResult& b);
std::string_view model_name(std::size_t model);

/// Largest difference of wrenches (torque over 10 mm of lever), in units of `pull` times a length:
/// how far a depth would have to be off, per model.
struct Off {
  std::array<double, kModels.size()> metres{};
  std::size_t touching = 0;  ///< poses with a force
  void note(const Rig& rig, const Pose& pose, const Answers& expected, const Answers& got);
  std::string text() const;
};

}  // namespace voxtouch::hard

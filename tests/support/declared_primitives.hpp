#pragma once
/// Whether the declared primitives of a scene match their mesh.
#include "core/reference/chord_error.hpp"

namespace voxtouch::test {

/// A declared primitive may differ from its mesh by this fraction of a voxel edge. A chord error
/// widens the undecided band of the validator, on both sides; a quarter of an edge costs about a
/// tenth of it.
inline constexpr double kChordRatioOfEdge = 0.25;

/// Largest distance of both [m]; 0 without primitives.
inline double primitives_off_m(const scene::MeshSpec& spec) {
  if (spec.primitives.empty())
    return 0.0;
  const reference::ReferenceMesh mesh = reference::read_reference_mesh(spec);
  return reference::chord_error(mesh, reference::MeshDistance(mesh), spec.primitives).value_m();
}

}  // namespace voxtouch::test

#pragma once
/// Whether the primitives that a scene declares for a mesh stand for it.
#include "core/reference/chord_error.hpp"

namespace voxtouch::test {

/// A declared primitive may differ from its mesh by this fraction of a voxel edge. A chord error
/// widens the band in which the validator decides nothing, on both sides; a quarter of an edge
/// costs about a tenth of it.
inline constexpr double kChordRatioOfEdge = 0.25;

/// How far both are apart at most [m]; 0 where none are declared.
inline double primitives_off_m(const scene::MeshSpec& spec) {
  if (spec.primitives.empty())
    return 0.0;
  const reference::ReferenceMesh mesh = reference::read_reference_mesh(spec);
  return reference::chord_error(mesh, reference::MeshDistance(mesh), spec.primitives).value_m();
}

}  // namespace voxtouch::test

#pragma once
/// Which sharp edges and corners of a mesh stand free, where several of its parts touch or overlap.
#include "core/exact/feature_mesh.hpp"

namespace voxtouch::exact {

/// Takes out of `row_edges` and `row_vertices` what another closed part covers: parts that overlap
/// or lie flush are one solid, and where two surfaces meet it is concave. Edges that are covered in
/// part are cut; so are rims that lie on another face of the same plane (T-junctions). Faces wholly
/// inside another part stay: nothing outside ever comes near them. Allocates.
void uncover_features(FeatureMesh& mesh);

}  // namespace voxtouch::exact

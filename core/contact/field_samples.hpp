#pragma once
/// Samples of the distance field at the hits of a block, and their forces. The loops over many
/// points are bit-identical to DistanceField::at.
#include "core/contact/penalty_kernel.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Samples of a block's hits, as FieldSample. The padding repeats the first hit.
struct FieldSamples {
  alignas(64) double distance_m[HitBlock::kHits], gradient[3][HitBlock::kHits];
  /// Of the eight nodes [e]: saturated at or below the stored depth.
  alignas(64) double least[HitBlock::kHits];
};

/// `local`: the tool's origin relative to the grid's [m]. Real-time safe.
void sample_block(const voxmap::DistanceField& field, const Vec3& local, const HitBlock& block,
                  FieldSamples& samples) noexcept;

/// Forces of a block's hits in the model `field`: along their normals, with half of the stiffness
/// along the normals and half along the gradients, which exert no force. `groups` are those with a
/// force. Records the deepest hit. Real-time safe.
/// \returns whether the force of any hit would not grow with depth. It is beyond the stored depth,
/// near the middle of a body, where the gradient vanishes, or past it, where the force points away
/// from the nearest exit.
bool field_forces(const HitBlock& block, const FieldSamples& samples, double depth_voxels,
                  PenaltyForces& along_normal, PenaltyForces& along_gradient,
                  PenaltyLanes& lanes) noexcept;

}  // namespace voxtouch::contact

#pragma once
/// What the distance field says at the hits of a block, and how they push by it: loops over many
/// points, each with the bits of DistanceField::at.
#include "core/contact/push_kernel.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Of a block's hits, as FieldSample has it. Beyond the block's hits: those of its first.
struct FieldSamples {
  alignas(64) double distance_m[HitBlock::kHits], gradient[3][HitBlock::kHits];
  alignas(64) double least[HitBlock::kHits];  ///< of the eight nodes [e]: at the depth that the
                                              ///< field holds, or below, it is saturated
};

/// `local`: the tool's origin from the grid's [m]. Real-time safe.
void sample_block(const voxmap::DistanceField& field, const Vec3& local, const HitBlock& block,
                  FieldSamples& samples) noexcept;

/// The plane that each sample defines: unit normal g / |g| and gap distance / |g|, of no meaning
/// where |g| is 0.
struct FieldPlanes {
  alignas(64) double steepness[HitBlock::kHits], normal[3][HitBlock::kHits], gap_m[HitBlock::kHits];
};
/// Real-time safe.
void find_planes(const HitBlock& block, const FieldSamples& samples, FieldPlanes& planes) noexcept;

/// How a block's hits push by the model `field`: along their normals, with half of the stiffness
/// along them and half along the gradients, which push not. `groups` are those with a hit that
/// pushes. Notes the deepest. \returns whether going deeper would meet no more push at any that
/// pushes: beyond what the field holds; near the middle of a body, where the gradient fades; or
/// beyond it, where the push points away from the nearest way out. Real-time safe.
bool push_by_field(const HitBlock& block, const FieldSamples& samples, double depth_voxels,
                   Pushes& along_normal, Pushes& along_gradient, PushLanes& lanes) noexcept;

}  // namespace voxtouch::contact

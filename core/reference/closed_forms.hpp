#pragma once
/// Signed distances of the primitives that a scene may declare.
#include <span>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Signed distance [m] (negative inside) and the nearest point of the surface, in the frame of the
/// query.
struct SignedPoint {
  double distance_m = 0.0;
  Vec3 nearest = Vec3::Zero();
};

/// Exact signed distance of `x` to a primitive, both in the mesh's frame after scaling [m]. Of
/// several nearest points one is chosen by a fixed rule. Does not allocate.
SignedPoint signed_distance(const scene::Primitive& primitive, const Vec3& x) noexcept;

/// The same for a union of at least one primitive. Exact outside. Inside, where primitives overlap
/// or touch, its magnitude is a lower bound of the depth.
SignedPoint signed_distance(std::span<const scene::Primitive> primitives, const Vec3& x) noexcept;

/// About `count` points spread over the primitive's surface, deterministic; includes corners, rims
/// and poles.
std::vector<Vec3> surface_samples(const scene::Primitive& primitive, std::size_t count);

}  // namespace voxtouch::reference

#pragma once
/// One interface for all contact models: the hits of a pose in, wrench out.
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/contact/hit_list.hpp"
#include "core/types/geometry.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Numbers as in ContactState; 3 was a model that is gone.
enum class ContactModelKind : std::uint8_t { kOriginal = 1, kAdapted = 2, kField = 4 };

/// "original", "adapted", ... ; and back (false where the word is unknown).
std::string_view name_of(ContactModelKind kind) noexcept;
/// The kind called `word`; false, and `kind` untouched, where there is none. Real-time safe.
bool parse_contact_model(std::string_view word, ContactModelKind& kind) noexcept;

/// What one pose gives. All in W; torque about the tool's origin.
struct ContactResult {
  Wrench wrench;
  Vec3 mean_normal = Vec3::Zero();  ///< normalised mean of the colliding points' normals; zero
                                    ///< where there are none
  double coherence = 0.0;           ///< |sum n| / |S|: 1 = all agree, 0 = they cancel
  std::uint32_t surface_hits = 0;   ///< |S|: shell points in surface voxels, also with depth 0
  std::uint32_t interior_hits = 0;  ///< shell points in interior voxels (gone through)
  Vec3 deepest_point =
      Vec3::Zero();              ///< the point with the largest depth [m]; zero without contact
  double deepest_depth_m = 0.0;  ///< [m]
  /// K sum w_i over the points that push. Bounds the spectral norm of dF/dx, x the tool's position,
  /// while the colliding set stays: -dF/dx = K sum w_i u_i u_i^T. Not bounded: the step when a
  /// point crosses a voxel border, and the stiffness against rotation.
  double stiffness_bound_n_per_m = 0.0;
  /// K sum w_i J_i' J_i over the same points, J_i = [u_i', (arm_i x u_i)']: stiffness [N/m, N,
  /// Nm/rad], W axes, about the tool's origin; symmetric, positive semidefinite. How -wrench
  /// changes with the depths while the colliding set stays; a rotation also turns arms and
  /// directions, which adds terms of the size of the wrench. A retained point counts like any
  /// other, so that the matrix does not fall where points go through.
  Mat6 stiffness = Mat6::Zero();
  bool fallback =
      false;  ///< normals face each other (coherence <= 0.3): `original` was used for this frame
  /// `field`: going deeper need not meet more force. Some point that pushes is deeper than the
  /// distances held, near the middle of a body
  /// (|gradient| < 1/2), or pushed away from the nearest way out (normal . gradient < -1/2).
  bool saturated = false;
  PoseStatus pose_status = PoseStatus::kUsable;
  std::uint32_t points_tested = 0;  ///< points that culling left to test
};

/// Turns the hits of one frame into a wrench. Memoryless; interior voxels give no force. Sums run
/// over the hits in their order, in double, so that a list gives bit-identical results whenever it
/// is evaluated. Real-time safe: no allocation, lock, throw.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual ContactModelKind kind() const noexcept = 0;
  /// Overwrites all of `result`.
  virtual void evaluate(const HitList& hits, ContactResult& result) const noexcept = 0;
  /// The same for a result that goes to the stage: where that blends directions it sums up all
  /// pushes anew, and they may be missing.
  virtual void evaluate_for_stage(const HitList& hits, ContactResult& result) const noexcept {
    evaluate(hits, result);
  }
};

/// The fraction of the mean normal in a surface point's direction, as the stage behind the model
/// blends it; 1 or 0: as the model itself.
double mean_weight(ContactModelKind kind, double coherence) noexcept;

/// What a shell point counts in every sum of a contact model.
enum class PointWeights : std::uint8_t {
  kOne,   ///< w_i = 1 (the paper): the force grows with the number of points that the shell happens
          ///< to have
  kArea,  ///< w_i = the point's fraction of the tool's surface [m^2]: the force belongs to the
          ///< contact's area
};

/// What the force laws need from the scene.
struct ContactParameters {
  /// K > 0: force for one metre of depth and a weight of one. [N/m] for points that weigh one each,
  /// [N/m^3], a pressure for one metre of depth, for areas.
  double stiffness = 1.0;
  PointWeights weights = PointWeights::kOne;
  /// ContactRenderer::render gives what the model gives, bit for bit: no depths are held, no
  /// directions blended (`original` and `adapted` as in the papers). Behind its layer of voxels
  /// nothing pushes back.
  bool memoryless = false;
};

/// The model for `kind`; `distances`, which `field` looks up, must outlive it. Throws
/// std::invalid_argument for a stiffness that is not finite and positive, and for `field` with
/// other weights than areas or without distances.
std::unique_ptr<ContactModel> make_contact_model(ContactModelKind kind,
                                                 const ContactParameters& parameters,
                                                 const voxmap::DistanceField* distances = nullptr);

}  // namespace voxtouch::contact

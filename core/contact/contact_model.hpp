#pragma once
/// Common interface of all contact models: from the hits of a pose to a wrench.
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/contact/hit_list.hpp"
#include "core/types/geometry.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Numbers of ContactState; 3 is reserved.
enum class ContactModelKind : std::uint8_t { kOriginal = 1, kAdapted = 2, kField = 4 };

/// Converts to "original", "adapted" or "field".
std::string_view name_of(ContactModelKind kind) noexcept;
/// Parses the name of a kind. Returns false, with `kind` unchanged, for an unknown name. Real-time
/// safe.
bool parse_contact_model(std::string_view word, ContactModelKind& kind) noexcept;

/// Contact result of one pose, in W; torque about the tool's origin.
struct ContactResult {
  Wrench wrench;
  /// Normalised mean of the normals of colliding points; zero without any.
  Vec3 mean_normal = Vec3::Zero();
  double coherence = 0.0;  ///< |sum n| / |S|: 1 = parallel, 0 = cancelling
  /// |S|: shell points in surface voxels, including those with depth 0.
  std::uint32_t surface_hits = 0;
  std::uint32_t interior_hits = 0;    ///< shell points in interior voxels
  Vec3 deepest_point = Vec3::Zero();  ///< the point of largest depth [m]; zero without contact
  double deepest_depth_m = 0.0;       ///< [m]
  /// K sum w_i over the points with force [N/m]. It bounds the spectral norm of dF/dx, with x the
  /// tool's position, for a constant set of colliding points:
  ///     -dF/dx = K sum w_i u_i u_i^T
  /// It bounds neither the step when a point crosses a voxel border nor the rotational stiffness.
  double stiffness_bound_n_per_m = 0.0;
  /// Stiffness over the same points, W axes, about the tool's origin [N/m, N, Nm/rad]; symmetric,
  /// positive semidefinite:
  ///     K sum w_i J_i' J_i,   J_i = [u_i', (arm_i x u_i)']
  /// It is the change of -wrench with the depths for a constant set of colliding points. A rotation
  /// also changes arms and directions, which adds terms of the size of the wrench. Latched points
  /// count like any other, so the matrix does not drop where points go through.
  Mat6 stiffness = Mat6::Zero();
  /// Opposite normals (coherence <= 0.3): `original` was used for this frame.
  bool fallback = false;
  /// `field`: the force may not grow with depth. Some point with force is deeper than the stored
  /// distances, is near the middle of a body (|gradient| < 1/2), or pushes away from the nearest
  /// exit (normal . gradient < -1/2).
  bool saturated = false;
  PoseStatus pose_status = PoseStatus::kUsable;
  std::uint32_t points_tested = 0;  ///< points left by the culling
};

/// Computes the wrench from the hits of one frame. Memoryless; interior voxels give no force. Sums
/// run over the hits in their order, in double, so a list always gives bit-identical results.
/// Real-time safe: no allocation, lock or exception.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual ContactModelKind kind() const noexcept = 0;
  /// Overwrites all of `result`.
  virtual void evaluate(const HitList& hits, ContactResult& result) const noexcept = 0;
  /// The same for a result that is passed to the stage. When the stage blends directions it
  /// recomputes the forces, so they may be missing here.
  virtual void evaluate_for_stage(const HitList& hits, ContactResult& result) const noexcept {
    evaluate(hits, result);
  }
};

/// Fraction of the mean normal in the direction of a surface point, as the stage blends it. At 1 or
/// 0 the direction is that of the model itself.
double mean_weight(ContactModelKind kind, double coherence) noexcept;

/// Weight of a shell point in every sum of a contact model.
enum class PointWeights : std::uint8_t {
  kOne,  ///< w_i = 1 (the paper): the force grows with the number of shell points
  /// w_i = the area that the point represents [m^2]: the force depends on the contact area.
  kArea,
};

/// Parameters of the force laws.
struct ContactParameters {
  /// K > 0: force per metre of depth for unit weight. [N/m] for unit weights; [N/m^3], a pressure
  /// per metre of depth, for areas.
  double stiffness = 1.0;
  PointWeights weights = PointWeights::kOne;
  /// ContactRenderer::render returns the result of the model, bit-identically: no latched depths,
  /// no blended directions (`original` and `adapted` as in the papers). Beyond its surface layer
  /// there is no force.
  bool memoryless = false;
};

/// Creates the model `kind`. `distances`, used by `field`, must outlive it. Throws
/// std::invalid_argument for a stiffness that is not finite and positive, and for `field` without
/// distances or without area weights.
std::unique_ptr<ContactModel> make_contact_model(ContactModelKind kind,
                                                 const ContactParameters& parameters,
                                                 const voxmap::DistanceField* distances = nullptr);

}  // namespace voxtouch::contact

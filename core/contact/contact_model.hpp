#pragma once
/// One interface for all rungs of accuracy: pose in, wrench out.
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/geometry.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch {

enum class ContactModelKind : std::uint8_t { kOriginal = 1, kAdapted = 2, kClustered = 3, kField = 4 };

/// "original", "adapted", ... ; and back (false where the word is unknown).
std::string_view name_of(ContactModelKind kind) noexcept;
bool parse_contact_model(std::string_view word, ContactModelKind& kind) noexcept;

/// What one pose gives. All in W; torque about the tool's origin.
struct ContactResult {
  Wrench wrench;
  Vec3 mean_normal = Vec3::Zero();      ///< normalised mean of the colliding points' normals; zero where there are none
  double coherence = 0.0;               ///< |sum n| / |S|: 1 = all agree, 0 = they cancel
  std::uint32_t surface_hits = 0;       ///< |S|: shell points in surface voxels, also with depth 0
  std::uint32_t interior_hits = 0;      ///< shell points in interior voxels (gone through)
  Vec3 deepest_point = Vec3::Zero();    ///< the point with the largest depth [m]; zero without contact
  double deepest_depth_m = 0.0;         ///< [m]
  double stiffness_bound_n_per_m = 0.0; ///< sum of the stiffnesses of all points that push: what a coupling must stand
  bool fallback = false;                ///< normals face each other: `original` was used for this frame
  std::uint32_t points_tested = 0;      ///< points that culling left to test
};

/// One colliding point of a frame.
struct Hit {
  std::uint32_t point = 0;  ///< index into the pointshell's arrays
  Vec3 arm = Vec3::Zero();      ///< from the tool's origin to the point, W axes [m]
  Vec3 normal = Vec3::Zero();   ///< inward normal, W axes
  Vec3 to_centre = Vec3::Zero();///< from the point to its voxel's centre, W axes [m]
};

/// Reserved once for the whole shell: filling it never allocates.
struct HitList {
  std::vector<Hit> surface;
  std::uint32_t interior = 0;
  std::uint32_t tested = 0;
  void reserve(std::size_t points) { surface.reserve(points); }
  void clear() noexcept { surface.clear(), interior = 0, tested = 0; }
};

/// Turns the hits of one frame into a wrench. Memoryless. Real-time safe: no allocation, no lock, no throw.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual ContactModelKind kind() const noexcept = 0;
  virtual void evaluate(const HitList& hits, ContactResult& result) const noexcept = 0;
};

/// What the force laws need from the scene.
struct ContactParameters {
  double stiffness_n_per_m = 1.0;  ///< K of each shell point (original, adapted), > 0
};

/// The model for `kind`. Throws std::invalid_argument for a rung that is not built yet, naming the ones that are.
std::unique_ptr<ContactModel> make_contact_model(ContactModelKind kind, const ContactParameters& parameters);

}  // namespace voxtouch

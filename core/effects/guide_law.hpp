#pragma once
/// Common law of the guides along points, lines and planes: a spring of limited force.
#include <array>
#include <limits>
#include <string>

#include "core/effects/effect.hpp"

namespace voxtouch::effects {

/// Force f(s) at the distance s >= 0 from a guide, with stiffness k, limit F and w = F / k:
///
///     0 .. w/2      f = k s, an ideal spring
///     .. 3w/2       f = k s - k (s - w/2)^2 / (2 w), a smooth transition to F
///     .. R/2        f = F
///     R/2 .. R      f = F (1 - smoothstep((s - R/2) / (R/2))), the release
///     beyond R      f = 0; an infinite R never releases
///
/// f and f' are continuous, and |f'|, f / s <= k everywhere if F <= k R / 3; a larger F is limited
/// to that.
struct GuideLaw {
  double stiffness_n_per_m = 0.0;
  double limit_n = 0.0;
  double range_m = std::numeric_limits<double>::infinity();
};

struct GuideForce {
  double force_n = 0.0;            ///< f, towards the guide
  double slope_n_per_m = 0.0;      ///< df/ds
  double per_metre_n_per_m = 0.0;  ///< f / s; k on the guide
  double potential_j = 0.0;        ///< integral of f from the guide to s
};

/// The law at `distance_m` >= 0. Real-time safe.
GuideForce guide_force(const GuideLaw& law, double distance_m) noexcept;
/// Work from the guide to its release [J]; infinite if it never releases.
double guide_depth_j(const GuideLaw& law) noexcept;

/// Reference of a guide's potential: zero far away if it releases, so that a region's border gives
/// no force there; otherwise zero on the guide.
double guide_potential_j(const GuideLaw& law, double from_guide_j) noexcept;

/// Adds the force of a guide at the distance |A y|. `away` = A y for the symmetric matrix
/// `constrained` = A with |A| <= 1, the projector on the constrained directions. Real-time safe.
/// With u along `away`:
///     force     -f A away / |away|
///     stiffness A (max(f', 0) u u' + f/s (1 - u u')) A
void pull_to_guide(const GuideLaw& law, const Vec3& away, const Mat3& constrained,
                   EffectForce& sum) noexcept;

/// Parameters of every guide, at these indices of its table.
enum GuideParameter : std::size_t {
  kGuideStiffness,
  kGuideLimit,
  kGuideBeyond,
  kGuideRange,
  kGuideOwn
};
/// The rows of a guide's table: the common ones, then its own.
template <class... Own>
constexpr std::array<EffectParameter, kGuideOwn + sizeof...(Own)> guide_rows(const Own&... own) {
  return {row::number("stiffness_n_per_m", 0.0, 10000.0,
                      "Stiffness of the spring close to the guide [N/m]."),
          row::number("limit_n", 0.0, 100.0, "Largest force of the guide [N], reached smoothly."),
          row::word("beyond", "hold release",
                    "Far from the guide: hold pulls with limit_n, release ends at range_m."),
          row::number("range_m", 0.0, 10.0, 0.0,
                      "With `beyond: release`: distance of zero force [m]. At least 3 limit_n / "
                      "stiffness_n_per_m."),
          own...};
}

/// The law of a guide with these values: stiffness [N/m], limit [N] and range [m]. Real-time safe.
GuideLaw guide_law(const EffectValues& values) noexcept;
/// Checks that the values fit together; returns a sentence or an empty text.
std::string check_guide(const EffectValues& values);
/// Bounds: k, F and the depth of the potential.
EffectBound guide_bound(const EffectValues& values);

}  // namespace voxtouch::effects

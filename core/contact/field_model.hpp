#pragma once
/// The contact model `field`: depths from the interpolated signed distance, each point's own
/// normal, area weights.
#include "core/contact/contact_model.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// F = k sum A_i d_i n_i over the points in surface and in interior voxels, d_i = max(0,
/// -phi(x_i)); torque sum r_i x F_i.
///
/// The law. Let the static object be a medium whose pressure is k times the depth below its
/// surface, D = max(0, -phi). The tool's surface dB then feels F = k int_dB D n dA, n inward, and
/// the sum above is that integral by one point for each piece of the surface. With E = k int_B D dV
/// over the tool's volume B, moving the tool by dx sweeps the volume -n . dx dA, so dE = -k int_dB
/// D n . dx dA = -F . dx, and likewise for rotations: in the continuum the force is conservative,
/// whatever the shapes. (Hydrostatic pressure; by the divergence theorem F is also -k times the
/// integral of grad D over the immersed volume, which is why it keeps pushing when the tool is
/// wholly inside.) What the sum misses is its quadrature error.
///
/// Continuity. phi is continuous and 0 at the border between surface and free voxels at the latest
/// (distance_field.hpp), so a point that comes or goes does so without a push. Between two poses no
/// point of which moves by more than s and that turn by theta, |F1 - F0| <= k sum A_i (G s + d_i
/// theta) over the points that push at either, G the steepest gradient of the field (at most
/// sqrt(3), 1 over flat walls).
///
/// `stiffness`: -dF/dx = k sum A_i n_i g_i', g_i the gradient of phi, need not be symmetric for a
/// sum of finitely many points. With g = |g| h, sym(n h') <= (n n' + h h')/2, since (n - h)(n - h)'
/// >= 0; the same holds for Jn = [n', (r x n)'] and Jh = [h', (r x h)']. Given is k sum A_i |g_i|/2
/// (Jn'Jn + Jh'Jh): symmetric, positive semidefinite, at least the symmetric part of the true one
/// while the set stays; the trace of its translational part, k sum A_i |g_i|, is
/// `stiffness_bound_n_per_m` and bounds |dF/dx|.
///
/// `mean_normal` and `coherence` are weighed by area over all hits, those in interior voxels
/// included. `saturated`: see there. Points at a depth of 0, or without an area, do not push: they
/// have no part in `stiffness` and the deepest is none of them.
class FieldModel final : public ContactModel {
 public:
  /// `field` must outlive the model. `stiffness` k [N/m^3].
  FieldModel(const voxmap::DistanceField& field, double stiffness)
      : field_(field),
        stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kField; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override;

 private:
  void add_pushes(const Hits& hits, const Vec3& tool, StiffnessSum& sum,
                  ContactResult& result) const noexcept;

  const voxmap::DistanceField& field_;
  double stiffness_;
};

}  // namespace voxtouch::contact

#pragma once
/// The contact model `field`: depths from the interpolated signed distance, each point's own
/// normal, area weights.
#include "core/contact/contact_model.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Force over the points in surface and interior voxels, with torque sum r_i x F_i:
///     F = k sum A_i d_i n_i,   d_i = max(0, -phi(x_i))
/// It is conservative and continuous; laws.md has the proofs and the definition of `stiffness`.
/// `mean_normal` and `coherence` are weighted by area over all hits, including those in interior
/// voxels. Points with zero depth or area have no force: they do not contribute to `stiffness` and
/// are never the deepest point.
class FieldModel final : public ContactModel {
 public:
  /// `field` must outlive the model. `stiffness` k [N/m^3].
  FieldModel(const voxmap::DistanceField& field, double stiffness)
      : field_(field),
        stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kField; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override;

 private:
  void add_forces(const Hits& hits, const Vec3& tool, StiffnessSum& sum,
                  ContactResult& result) const noexcept;

  const voxmap::DistanceField& field_;
  double stiffness_;
};

}  // namespace voxtouch::contact

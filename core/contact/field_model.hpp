#pragma once
/// The contact model `field`: depths from the interpolated signed distance, each point's own
/// normal, area weights.
#include "core/contact/contact_model.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// F = k sum A_i d_i n_i over the points in surface and in interior voxels, d_i = max(0,
/// -phi(x_i)); torque sum r_i x F_i. Conservative and continuous; proofs, and what `stiffness` is,
/// in laws.md.
///
/// `mean_normal` and `coherence` are weighed by area over all hits, those in interior voxels
/// included. Points at a depth of 0, or without an area, do not push: they have no part in
/// `stiffness` and the deepest is none of them.
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

#include "core/contact/contact_model.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/contact/field_model.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/penalty_sums.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::contact {
namespace {

struct NamedModel {
  ContactModelKind kind;
  std::string_view name;
};
constexpr NamedModel kModels[] = {{ContactModelKind::kOriginal, "original"},
                                  {ContactModelKind::kAdapted, "adapted"},
                                  {ContactModelKind::kField, "field"}};

/// Sets the results common to both laws: counts, mean normal, coherence. Returns true if the
/// normals are sufficiently coherent.
bool summarise(const HitList& hits, ContactResult& result) noexcept {
  begin_result(hits, result);
  if (!(hits.surface.weight_sum() > 0.0))
    return true;
  set_mean_normal(hits.surface.normal_sum(), hits.surface.weight_sum(), result);
  return result.coherence > limits::kFallbackCoherence;
}

/// McNeely 1999: F = K sum w_i d_i n_i, d_i = max(0, n_i . (c_i - x_i)).
void add_forces_along_own_normals(const HitList& hits, double stiffness,
                                  ContactResult& result) noexcept {
  StiffnessSum sum;
  add_forces_along_directions(hits.surface, {}, stiffness, hits.pose_WT.position, result, sum);
  if (sum.any())
    sum.add_to(stiffness, result.stiffness);
}

std::unique_ptr<ContactModel> make_field_model(const ContactParameters& parameters,
                                               const voxmap::DistanceField* distances) {
  if (parameters.weights != PointWeights::kArea)
    throw std::invalid_argument("contact: model 'field' has area weights; set stiffness_n_per_m3");
  if (distances == nullptr)
    throw std::invalid_argument("contact: model 'field' needs a distance field; build it first");
  return std::make_unique<FieldModel>(*distances, parameters.stiffness);
}

class OriginalModel final : public ContactModel {
 public:
  explicit OriginalModel(double stiffness) : stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kOriginal; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override {
    summarise(hits, result);
    add_forces_along_own_normals(hits, stiffness_, result);
  }

 private:
  double stiffness_;
};

class AdaptedModel final : public ContactModel {
 public:
  explicit AdaptedModel(double stiffness) : stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kAdapted; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override {
    evaluate(hits, false, result);
  }
  void evaluate_for_stage(const HitList& hits, ContactResult& result) const noexcept override {
    evaluate(hits, true, result);
  }

 private:
  void evaluate(const HitList& hits, bool stage_blends, ContactResult& result) const noexcept {
    const bool agree = summarise(hits, result);
    result.fallback = !agree;
    const double fraction = mean_weight(kind(), result.coherence);
    if (stage_blends && fraction > 0.0 && fraction < 1.0)
      return;
    if (agree)
      // Paper, section 2.2: F = K m sum w_i d_i, d_i = max(0, m . (c_i - x_i)), m the mean normal.
      add_forces_along_mean(hits.surface, result.mean_normal, stiffness_, hits.pose_WT.position,
                            result);
    else
      add_forces_along_own_normals(hits, stiffness_, result);
  }

  double stiffness_;
};

}  // namespace

double mean_weight(ContactModelKind kind, double coherence) noexcept {
  return kind == ContactModelKind::kOriginal
             ? 0.0
             : smoothstep(limits::kBlendFrom, limits::kBlendTo, coherence);
}

std::string_view name_of(ContactModelKind kind) noexcept {
  for (const NamedModel& model : kModels)
    if (model.kind == kind)
      return model.name;
  return "unknown";
}

bool parse_contact_model(std::string_view word, ContactModelKind& kind) noexcept {
  for (const NamedModel& model : kModels)
    if (model.name == word)
      return kind = model.kind, true;
  return false;
}

std::unique_ptr<ContactModel> make_contact_model(ContactModelKind kind,
                                                 const ContactParameters& parameters,
                                                 const voxmap::DistanceField* distances) {
  const double stiffness = parameters.stiffness;
  if (!(stiffness > 0.0) || !std::isfinite(stiffness))
    throw std::invalid_argument("contact: the stiffness is " + std::to_string(stiffness) +
                                "; it must be finite and greater than 0");
  switch (kind) {
    case ContactModelKind::kOriginal:
      return std::make_unique<OriginalModel>(stiffness);
    case ContactModelKind::kAdapted:
      return std::make_unique<AdaptedModel>(stiffness);
    case ContactModelKind::kField:
      return make_field_model(parameters, distances);
  }
  throw std::invalid_argument("contact: unknown model");
}

}  // namespace voxtouch::contact

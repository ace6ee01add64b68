#include "core/contact/contact_model.hpp"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/contact/clustered_model.hpp"
#include "core/contact/field_model.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"original", "adapted", "clustered", "field"};

/// What both laws report in the same way: counts, mean normal, coherence. True if the points agree well enough on it.
bool summarise(const HitList& hits, ContactResult& result) noexcept {
  result = {};
  result.surface_hits = static_cast<std::uint32_t>(hits.surface.size());
  result.interior_hits = static_cast<std::uint32_t>(hits.interior.size());
  result.points_tested = hits.tested;
  result.pose_status = hits.pose_status;
  if (hits.surface.empty()) return true;
  Vec3 sum = Vec3::Zero();
  double weights = 0.0;
  for (const Hit& hit : hits.surface) {
    sum += hit.weight * hit.normal;
    weights += hit.weight;
  }
  const double length = sum.norm();
  if (weights > 0.0) result.coherence = length / weights;
  if (length > 0.0) result.mean_normal = sum / length;
  return result.coherence > contact_limits::kFallbackCoherence;
}

/// Counts a point that pushes and remembers the deepest; the first of equals wins.
void note_depth(const HitList& hits, const Hit& hit, double depth, double stiffness, ContactResult& result) noexcept {
  if (depth > 0.0) result.stiffness_bound_n_per_m += stiffness * hit.weight;
  if (depth > result.deepest_depth_m) {
    result.deepest_depth_m = depth;
    result.deepest_point = hits.pose.position + hit.arm;
  }
}

/// McNeely 1999: F = K sum w_i d_i n_i, d_i = max(0, n_i . (c_i - x_i)).
void push_along_own_normals(const HitList& hits, double stiffness, ContactResult& result) noexcept {
  StiffnessSum sum;
  for (const Hit& hit : hits.surface) {
    const double depth = std::max(0.0, hit.normal.dot(hit.to_centre));
    const Vec3 force = (stiffness * (hit.weight * depth)) * hit.normal;
    result.wrench.force += force;
    result.wrench.torque += hit.arm.cross(force);
    note_depth(hits, hit, depth, stiffness, result);
    if (depth > 0.0) sum.add(hit.arm, hit.normal, hit.weight);
  }
  if (sum.any()) sum.add_to(stiffness, result.stiffness);
}

/// Paper, section 2.2: F = K m sum w_i d_i, d_i = max(0, m . (c_i - x_i)), m the mean normal.
void push_along_mean_normal(const HitList& hits, double stiffness, ContactResult& result) noexcept {
  const Vec3 mean = result.mean_normal;
  double depths = 0.0;
  Vec3 moment = Vec3::Zero();
  CommonDirectionSum sum;
  for (const Hit& hit : hits.surface) {
    const double depth = std::max(0.0, mean.dot(hit.to_centre));
    const double weighed = hit.weight * depth;
    depths += weighed;
    moment += weighed * hit.arm;
    note_depth(hits, hit, depth, stiffness, result);
    if (depth > 0.0) sum.add(hit.arm, hit.weight);
  }
  result.wrench.force = (stiffness * depths) * mean;
  result.wrench.torque = moment.cross(stiffness * mean);
  result.stiffness = sum.matrix(stiffness, mean);
}

std::unique_ptr<ContactModel> make_field_model(const ContactParameters& parameters, const ContactGround& ground) {
  if (parameters.weights != PointWeights::kArea)
    throw std::invalid_argument("contact: the model 'field' weighs points by their area; give its stiffness per area "
                                "(stiffness_n_per_m3)");
  if (ground.field == nullptr)
    throw std::invalid_argument("contact: the model 'field' looks up a distance field, and there is none; build it first");
  return std::make_unique<FieldModel>(*ground.field, parameters.stiffness);
}

class OriginalModel final : public ContactModel {
 public:
  explicit OriginalModel(double stiffness) : stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kOriginal; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override {
    summarise(hits, result);
    push_along_own_normals(hits, stiffness_, result);
  }

 private:
  double stiffness_;
};

class AdaptedModel final : public ContactModel {
 public:
  explicit AdaptedModel(double stiffness) : stiffness_(stiffness) {}
  ContactModelKind kind() const noexcept override { return ContactModelKind::kAdapted; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override {
    if (summarise(hits, result)) {
      push_along_mean_normal(hits, stiffness_, result);
    } else {
      push_along_own_normals(hits, stiffness_, result);
      result.fallback = true;
    }
  }

 private:
  double stiffness_;
};

}  // namespace

std::string_view name_of(ContactModelKind kind) noexcept {
  const auto index = static_cast<std::size_t>(kind) - 1;
  return index < kNames.size() ? kNames[index] : std::string_view("unknown");
}

bool parse_contact_model(std::string_view word, ContactModelKind& kind) noexcept {
  for (std::size_t index = 0; index < kNames.size(); ++index) {
    if (word != kNames[index]) continue;
    kind = static_cast<ContactModelKind>(index + 1);
    return true;
  }
  return false;
}

std::unique_ptr<ContactModel> make_contact_model(ContactModelKind kind, const ContactParameters& parameters,
                                                 const ContactGround& ground) {
  const double stiffness = parameters.stiffness;
  if (!(stiffness > 0.0) || !std::isfinite(stiffness))
    throw std::invalid_argument("contact: the stiffness is " + std::to_string(stiffness) +
                                "; it must be finite and greater than 0");
  switch (kind) {
    case ContactModelKind::kOriginal: return std::make_unique<OriginalModel>(stiffness);
    case ContactModelKind::kAdapted: return std::make_unique<AdaptedModel>(stiffness);
    case ContactModelKind::kField: return make_field_model(parameters, ground);
    case ContactModelKind::kClustered: return make_clustered_model(parameters, ground);
  }
  throw std::invalid_argument("contact: there is no such model");
}

}  // namespace voxtouch

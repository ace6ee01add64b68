#pragma once
/// A scene's time budget as counts of work: the same on every machine, so that a frame is the same
/// bits wherever it runs. No clock is asked.
#include <cstdint>

#include "core/contact/contact_model.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {

/// What a frame with so many objects and points is made of.
struct FrameWork {
  contact::ContactModelKind model = contact::ContactModelKind::kAdapted;
  bool virtual_tool = false;
  std::uint64_t objects = 1, shell_points = 0, edge_points = 0;
  std::uint64_t tool_points = 0;  ///< that effects look round from
};

/// Points that a frame may test of each object within `budget_us`, by penalty: what is left of the
/// time when the look-ups of all objects and all effects have had theirs at most, over what a point
/// takes that is tested, touches and is weighed (ns_per_budget_point). Throws
/// std::invalid_argument, a sentence with the least budget, where it is too little to keep what a
/// budget promises (FrameBudget::kMinPoints).
std::uint32_t points_within(double budget_us, const scene::Scene& scene, const FrameWork& work);

/// What a look-up counts as beside its points [ns]: choosing levels, and what model and stage do
/// once. Measured: 1.8 us at 51 points.
inline constexpr double kNsPerLookup = 2000.0;
/// What a point counts as [ns]; and what queries and steps of a virtual tool have together of
/// `budget_us` [ns].
double ns_per_budget_point(contact::ContactModelKind model) noexcept;
double tool_ns_within(double budget_us, const scene::Scene& scene, const FrameWork& work);
/// What a frame of a virtual tool takes whatever its budget: the queries that are always made, with
/// every point of the tool near something [ns].
double least_tool_ns(const FrameWork& work) noexcept;

}  // namespace voxtouch::rendering

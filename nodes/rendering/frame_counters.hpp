#pragma once
/// What the rendering counts of its frames, and what it shows of one to tools that draw points.
#include "core/rendering/live_scene.hpp"
#include "nodes/rendering/ros_outputs.hpp"
#include "nodes/runtime/counters.hpp"

namespace voxtouch::rendering_node {

enum class FrameCounter : std::uint8_t {
  kSamples,
  kFirstSample,
  kLongestUs,
  kContact,
  kRefused,
  kFast,
  kTunnellingSuspected,
  kPassedThrough,
  kFullyInside,
  kLatched,
  kSaturated,
  kNotConverged,
  kNotInitialised,
  kMostQueries,
  kResidual,
  kPenetration  // of a virtual tool
};
inline constexpr auto kFrameTable = [] {
  using enum FrameCounter;
  using enum runtime::Counting;
  return std::to_array<runtime::CounterRow<FrameCounter>>({
      {kSamples, "samples", "samples"},
      {kFirstSample, "first_sample", "sample number", kLast},
      {kLongestUs, "longest_frame_us", "us", kMaximum},
      {kContact, "contact_samples", "samples"},
      {kRefused, "refused_samples", "samples"},
      {kFast, "fast_samples", "samples"},
      {kTunnellingSuspected, "tunnelling_suspected_samples", "samples"},
      {kPassedThrough, "passed_through_samples", "samples"},
      {kFullyInside, "fully_inside_samples", "samples"},
      {kLatched, "latched_samples", "samples"},
      {kSaturated, "saturated_samples", "samples"},
      {kNotConverged, "not_converged_samples", "samples"},
      {kNotInitialised, "not_initialised_samples", "samples"},
      {kMostQueries, "samples_at_most_queries", "samples"},
      {kResidual, "most_residual_m", "m", kMaximum},
      {kPenetration, "most_penetration_m", "m", kMaximum},
  });
}();
using FrameCounters = runtime::Counters<kFrameTable>;

/// Counts `frame`, which was published as `message`. Real-time safe.
void count(FrameCounters& counters, const rendering::SceneFrame& frame,
           const msg::ContactState& message) noexcept;

/// For the ROS outputs; `hand`: where the hand holds T, in W. Real-time safe.
Shown shown_of(const rendering::SceneFrame& frame, const msg::ContactState& message,
               const Pose& hand) noexcept;
/// All points of the last query in contact, or every n-th of them; of a virtual tool the deepest
/// alone. Real-time safe.
ShownPoints points_of(const rendering::SceneFrame& frame, rendering::LiveScene& live,
                      bool virtual_tool) noexcept;

}  // namespace voxtouch::rendering_node

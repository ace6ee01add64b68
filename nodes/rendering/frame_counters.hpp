#pragma once
/// Counters of rendered frames, and extracts of a frame for the ROS outputs.
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
  kAtWorkLimit,
  kResidual
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
      {kAtWorkLimit, "samples_at_work_limit", "samples"},
      {kResidual, "most_residual_m", "m", kMaximum},
  });
}();
using FrameCounters = runtime::Counters<kFrameTable>;

/// Counts `frame`, which was published as `message`. Real-time safe.
void count(FrameCounters& counters, const rendering::SceneFrame& frame,
           const msg::ContactState& message) noexcept;

/// Extract for the ROS outputs. `hand`: pose of T requested by the operator, in W. Real-time safe.
Shown shown_of(const rendering::SceneFrame& frame, const msg::ContactState& message,
               const Pose& hand) noexcept;
/// All contact points of the last query, or every n-th of them. With a virtual tool only the
/// deepest point. Real-time safe.
ShownPoints points_of(const rendering::SceneFrame& frame, rendering::LiveScene& live,
                      bool virtual_tool) noexcept;

}  // namespace voxtouch::rendering_node

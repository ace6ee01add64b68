#pragma once
/// What the parts of a plan take, measured frame by frame along the scene's motion.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/coupling/coupling_spec.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::cli {

struct MeasureOptions {
  int frames = 1000;
  std::function<double()> cpu_time_s;  ///< a clock that counts this thread's CPU time [s]
  std::optional<coupling::CouplingSpec>
      coupling;  ///< what to step, in W; none: the coupling is not measured
};

/// One part of Plan::parts, by its name. Medians over the frames in contact; over all where none
/// is.
struct PartTime {
  std::string part;
  double expected_ns = 0.0;  ///< from what these frames counted: points left by culling, hits
  double measured_ns = 0.0;
};

struct PlanTimes {
  std::string along;  ///< the motion's name; empty: seeded places round the static objects
  int frames = 0, touching = 0;
  double points_tested = 0.0, hits = 0.0;  ///< medians
  std::vector<PartTime> parts;             ///< those that take time of their own
  double frame_median_ns = 0.0, frame_p95_ns = 0.0,
         frame_worst_ns = 0.0;  ///< contact and effects, likewise
  double frame_free_ns = 0.0;   ///< median of the frames out of contact; 0: none was
  bool slides = false;          ///< frames of a hand that slides: with a virtual tool
  double queries_per_frame =
      1.0;  ///< mean over the frames in contact; without a virtual tool each makes one
};

/// Each frame's parts are timed in batches of the same frame and what asking for the time costs is
/// taken off; the contact model is what a whole contact takes above finding its hits. A virtual
/// tool makes no query while its hand rests. So from each place the hand slides sideways
/// (accuracy::kSlideEdges a frame, kBatch frames), each of these frames is timed by itself, and the
/// virtual tool is what they take above their effects. Leaves the renderer reset.
PlanTimes measure_plan(const scene::Scene& scene, rendering::BuiltScene& built,
                       const MeasureOptions& options);

}  // namespace voxtouch::cli

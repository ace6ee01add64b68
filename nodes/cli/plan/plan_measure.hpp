#pragma once
/// Times of the parts of a plan, measured frame by frame along the scene's motion.
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
  std::optional<coupling::CouplingSpec> coupling;  ///< coupling to step, in W; none: not measured
};

/// One part of Plan::parts, by its name. Medians over the frames in contact, or over all if there
/// is none.
struct PartTime {
  std::string part;
  double expected_ns = 0.0;  ///< from the counts in these frames: points left by culling, hits
  double measured_ns = 0.0;
};

struct PlanTimes {
  std::string along;  ///< the motion's name; empty: seeded places round the static objects
  int frames = 0, touching = 0;
  double points_tested = 0.0, hits = 0.0;  ///< medians
  std::vector<PartTime> parts;             ///< parts with a time
  double frame_median_ns = 0.0, frame_p95_ns = 0.0,
         frame_worst_ns = 0.0;  ///< contact and effects
  double frame_free_ns = 0.0;   ///< median of the frames out of contact; 0: none was
  bool slides = false;          ///< frames of a hand that slides: with a virtual tool
  double queries_per_frame =
      1.0;  ///< mean over the frames in contact; without a virtual tool each makes one
};

/// Each frame's parts are timed in batches of the same frame, and the cost of the clock is
/// subtracted. The time of the contact model is that of a whole contact minus that of finding its
/// hits. A virtual tool makes no query while its hand rests. Therefore the hand slides sideways
/// from each place (accuracy::kSlideEdges per frame, kBatch frames); each frame is timed, and the
/// time without effects counts as the virtual tool's. Leaves the renderer reset.
PlanTimes measure_plan(const scene::Scene& scene, rendering::BuiltScene& built,
                       const MeasureOptions& options);

}  // namespace voxtouch::cli

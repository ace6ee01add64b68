#pragma once
/// Accuracy and cost of contact settings, measured against the reference on the same contacts.
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/mesh/import.hpp"
#include "core/scene/scene.hpp"
#include "core/types/parallel.hpp"

namespace voxtouch::accuracy {

/// One contact model at one resolution.
struct AccuracySetting {
  contact::ContactModelKind model = contact::ContactModelKind::kAdapted;
  contact::PointWeights weights = contact::PointWeights::kOne;
  double voxel_m = 0.0;  ///< e of the static voxmap
  double shell_voxel_m =
      0.0;  ///< voxel edge that the pointshell is made with; e, or another for another density
  bool virtual_tool = false;  ///< the spring to a virtual tool, with `field`; its truth is a
                              ///< reference tool that follows the same hand (true_tools.hpp)

  bool operator==(const AccuracySetting&) const = default;
};

/// Reference of a virtual tool (true_tools.hpp).
enum class ToolTruth : std::uint8_t {
  kNone,       ///< no virtual tool
  kBall,       ///< the exact ball
  kGodObject,  ///< a god-object on the meshes' triangles
};

/// Both ends; NaN if unknown.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN(),
         high = std::numeric_limits<double>::quiet_NaN();
};

/// A missed contact has a force in the reference and none in the setting. It counts in every error:
/// direction 180 deg, force ratio 0, lever arm infinite.
struct ErrorFigures {
  std::uint32_t contacts = 0;  ///< evaluated poses: setting and reference both have a force
  std::uint32_t missed = 0;    ///< poses with a force in the reference only
  double direction_mean_deg =
      0.0;  ///< angle between this force and the reference's; settings are ranked by it
  double force_ratio = 0.0;      ///< mean of |F| / |F_reference|: 1 without bias
  double magnitude_noise = 0.0;  ///< standard deviation over mean of the same

  /// Ratio of missed contacts to expected ones; 0 if none is expected.
  double missed_ratio() const noexcept {
    return contacts + missed > 0 ? static_cast<double>(missed) / (contacts + missed) : 0.0;
  }
};

/// The errors at one depth. The tool is pressed in slowly from outside, as by a hand, so depths
/// latched by the stage are included.
struct DepthFigures : ErrorFigures {
  double edges = 0.0;  ///< depth in e of the setting
};

/// Least and largest over random places of the voxel grid.
struct PhaseFigures {
  std::uint32_t phases = 0;  ///< places of the grid that were built; 0: none, and nothing is known
  std::uint32_t contacts = 0;  ///< evaluated poses at each
  Interval direction_mean_deg, missed_ratio, force_ratio;
};

/// Results of one setting.
struct AccuracyRow : ErrorFigures {
  AccuracySetting setting;
  ToolTruth tool_truth = ToolTruth::kNone;
  std::uint32_t without_truth =
      0;  ///< places at which the reference of the virtual tool found no equilibrium
  std::uint64_t shell_points = 0;
  std::uint64_t bytes = 0;  ///< memory of voxmap, pointshell and field
  double direction_median_deg = 0.0;
  double direction_p95_deg = 0.0;
  double torque_error_m = 0.0;  ///< median of |torque error| / |F|, about the tool's origin: a
                                ///< lever arm [m]; infinite if half are missed
  /// Median gap at which the force begins on the path in, over the places with space behind the
  /// tool; > 0: too early [m].
  double onset_error_m = 0.0;
  Interval direction_median_95, torque_error_95, onset_error_95,
      median_us_95;                  ///< 95 % intervals of the medians (median_interval)
  std::vector<DepthFigures> depths;  ///< as AccuracyOptions::spread_depth_edges, or none
  PhaseFigures phases;
  double onset_worst_m = 0.0;  ///< the onset farthest from 0 [m]
  /// CPU time of a frame in contact (query, model, stage) over the evaluated poses. Each is the
  /// best of several rounds, which excludes interruptions. For a virtual tool: over all frames of a
  /// sliding hand (ToolPress::slide).
  double median_us = 0.0, p95_us = 0.0, worst_us = 0.0;
  double queries_per_frame =
      1.0;               ///< mean over the frames that are timed; a penalty model makes one
  double build_s = 0.0;  ///< CPU time from meshes to a renderer
  std::string refused;   ///< why this setting could not be built; all figures above are then 0
};

/// How it is measured.
struct AccuracyOptions {
  std::uint64_t seed = 1;
  std::uint32_t contacts = 200;  ///< contact poses, the same for every setting save their depth
  double depth_edges = 0.5;      ///< depth of each contact, in e of its setting
  /// Spread over depth and over the grid's place: so many of the contacts, at these depths [e of
  /// the setting], and so many random places of the grid. 0 or none: it is left out.
  std::uint32_t spread_contacts = 60;
  std::vector<double> spread_depth_edges = {0.25, 0.5, 1.0, 2.0, 4.0};
  std::uint32_t phases = 4;
  std::function<double()>
      cpu_time_s;  ///< a clock that counts this thread's CPU time [s]; none: times read 0
  /// Called often, first before anything is measured; 0 <= fraction <= 1, roughly of the time;
  /// `left_s`: CPU time left, as guessed and then measured [s].
  std::function<void(const std::string& what, double fraction, double left_s)> progress;
  mesh::TriangleReader read = mesh::read_triangles;  ///< see BuildChoices
};

/// Places: random points of the static surface, uniform by area. The tool meets each along the
/// surface's normal there, with a random rotation about it. The touch is found by repeated moves by
/// the remaining distance. From there the tool moves in by the requested depth. Walls, edges and
/// corners thus occur in the mesh's proportions. Reference: ReferenceWrench, at a resolution equal
/// to the depth.
///
/// Rows in the order of `settings`. Reads the scene's meshes. Throws MeshError and
/// std::runtime_error if the scene cannot be measured. A setting that cannot be built is a row with
/// the reason.
std::vector<AccuracyRow> measure_accuracy(const scene::Scene& scene,
                                          const std::vector<AccuracySetting>& settings,
                                          const AccuracyOptions& options,
                                          const ParallelFor& parallel_for);

}  // namespace voxtouch::accuracy

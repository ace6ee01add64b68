#pragma once
/// What accuracy costs in time: every setting of the contact measured against the reference, on the
/// same contacts.
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

/// What a virtual tool is compared with (true_tools.hpp).
enum class ToolTruth : std::uint8_t {
  kNone,       ///< no virtual tool
  kBall,       ///< the exact ball
  kGodObject,  ///< a god-object on the meshes' triangles
};

/// Two ends; NaN where they are not known.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN(),
         high = std::numeric_limits<double>::quiet_NaN();
};

/// A missed contact, one where the reference pushes and the setting does not, counts in every
/// error: its direction is 180 deg off, its force is none of the true one, its lever arm is
/// infinite.
struct ErrorFigures {
  std::uint32_t contacts =
      0;  ///< poses that were judged: both this setting and the reference push there
  std::uint32_t missed = 0;  ///< poses where the reference pushes and this setting does not
  double direction_mean_deg =
      0.0;  ///< angle between this force and the reference's: what settings are ranked by
  double force_ratio = 0.0;      ///< mean of |F| / |F_reference|: 1 without bias
  double magnitude_noise = 0.0;  ///< standard deviation over mean of the same

  /// Of all places where a contact is due, those without one; 0 where none was due.
  double missed_ratio() const noexcept {
    return contacts + missed > 0 ? static_cast<double>(missed) / (contacts + missed) : 0.0;
  }
};

/// The same at one depth, the tool pressed in slowly from outside, as a hand does it: with what the
/// stage holds.
struct DepthFigures : ErrorFigures {
  double edges = 0.0;  ///< depth in e of the setting
};

/// Least and largest over random places of the voxel grid.
struct PhaseFigures {
  std::uint32_t phases = 0;  ///< places of the grid that were built; 0: none, and nothing is known
  std::uint32_t contacts = 0;  ///< poses judged at each
  Interval direction_mean_deg, missed_ratio, force_ratio;
};

/// What one setting gives and costs.
struct AccuracyRow : ErrorFigures {
  AccuracySetting setting;
  ToolTruth tool_truth = ToolTruth::kNone;
  std::uint32_t without_truth =
      0;  ///< places where the reference of the virtual tool found no rest
  std::uint64_t shell_points = 0;
  std::uint64_t bytes = 0;  ///< voxmap, pointshell, field: all that the contact model keeps
  double direction_median_deg = 0.0;
  double direction_p95_deg = 0.0;
  double torque_error_m = 0.0;  ///< median of |torque error| / |F|, about the tool's origin: a
                                ///< lever arm [m]; infinite where half is missed
  /// Median of the gap where the force begins, along the way in, over the places with room behind
  /// the tool; > 0: too early [m].
  double onset_error_m = 0.0;
  Interval direction_median_95, torque_error_95, onset_error_95,
      median_us_95;                  ///< 95 % intervals of the medians (median_interval)
  std::vector<DepthFigures> depths;  ///< as AccuracyOptions::spread_depth_edges, or none
  PhaseFigures phases;
  double onset_worst_m = 0.0;  ///< the onset farthest from 0 [m]
  /// CPU time of a frame in contact (query, model, stage) over the poses that were judged, each at
  /// its best of several rounds, so that it is the pose's and not the machine's. Of a virtual tool:
  /// over all frames of a hand that slides (ToolPress::slide).
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

/// Places: random points of the static surface, area for area, which the tool meets along the
/// surface's normal there, turned at random; the touch is found by moving it on by its distance
/// until nothing is left. From there it goes in by the requested depth. So walls, edges and corners
/// come as often as the mesh has them. What there is to report: ReferenceWrench, at a resolution
/// of the depth itself.
///
/// Rows in the order of `settings`. Reads the scene's meshes itself. Throws MeshError and
/// std::runtime_error, each a sentence, where the scene as such cannot be measured; a single
/// setting that cannot be built is a row that says why.
std::vector<AccuracyRow> measure_accuracy(const scene::Scene& scene,
                                          const std::vector<AccuracySetting>& settings,
                                          const AccuracyOptions& options,
                                          const ParallelFor& parallel_for);

}  // namespace voxtouch::accuracy

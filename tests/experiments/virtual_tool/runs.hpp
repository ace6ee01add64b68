#pragma once
/// What is measured of the virtual tool: presses, slides, walls and tumbling, each against what
/// must come of it.
#include <cstdint>
#include <string>
#include <vector>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// The ball pushed `depth_m` deep at random places, up to 20 degrees askew (at "edge" and "corner"
/// straight), at 50 mm/s; then the hand rests.
struct PressOptions {
  std::string scene = "plane";
  double edge = 0.002, depth_m = 0.01;
  int places = 100;
  bool turned = false;
  std::uint64_t seed = 1;
};
struct PressFigures {
  double direction_median = 0.0, direction_95 = 0.0;  ///< against the god-object [degrees]
  double size_median = 0.0, size_least = 0.0,
         size_most = 0.0;  ///< |F| over the god-object's, less one
  double rest_median = 0.0, rest_95 = 0.0,
         rest_worst = 0.0;  ///< |F| from frame to frame while the hand rests [N]
  double queries_mean = 0.0;
  int queries_most = 0;
  double depth_worst = 0.0;  ///< of a row, at rest [e]
  double residual_95 = 0.0;  ///< [e]
  int places = 0, slid = 0;  ///< slid: the truth went more than 5 mm aside, round an edge; not in
                             ///< the figures, but at "edge" and "corner"
  double frame_us = 0.0;
};
PressFigures press(const PressOptions& options);

/// A circle of 20 mm radius (on "cylinder" and "tilted" likewise, across the normal), the hand
/// `depth_m` deep.
struct SlideOptions {
  std::string scene = "plane";
  double edge = 0.002, depth_m = 0.01, speed = 0.05, friction = 0.0;
  std::uint64_t seed = 1;
};
struct SlideFigures {
  double mean = 0.0, noise = 0.0;  ///< |F| [N]; std over mean
  double direction_median = 0.0, direction_95 = 0.0;
  double step_worst = 0.0,
         step_over_force = 0.0;  ///< of the force from frame to frame [N]; over the force
  double energy_per_path =
      0.0;  ///< given by the loop over |F| times way; below zero: taken from the hand
  double queries_mean = 0.0;
  int queries_most = 0;
  double frame_us = 0.0, frame_us_999 = 0.0;
};
SlideFigures slide(const SlideOptions& options);

/// A ball that is driven through a plate from random sides, then rubbed along it.
struct WallOptions {
  double thick_edges = 1.0, edge = 0.002;
  bool askew = false;
  int tries = 5;
  std::vector<double> edges_per_frame = {0.02, 0.1, 0.5, 1.0, 2.0, 4.0};
  std::uint64_t seed = 1;
};
struct WallFigures {
  int runs = 0, passed = 0;
  double depth_worst = 0.0;  ///< of a row [e]
  double rest_median = 0.0, rest_95 = 0.0,
         rest_worst = 0.0;  ///< |F| from frame to frame, hand still [N]
  double queries_mean = 0.0;
  int queries_most = 0;  ///< of a frame
  std::vector<std::string> lines;
};
WallFigures walls(const WallOptions& options);

/// Tools that start at a plate, which reaches into them by so much: by more than half a voxel it is
/// no start.
struct StartOptions {
  Vec3 box = Vec3::Zero();  ///< edges of the tool [e]; zero: a ball, and ...
  double radius_edges = 5.0;
  double thick_edges = 1.0, edge = 0.002;
  bool askew = false, rim = false;  ///< the plate; the tool at its rim instead of over its face
  bool turned = true;               ///< the tool, at random
  double from_edges = 0.0,
         to_edges = 0.0;  ///< how deep the plate is inside the tool; below zero: so far away
  int tries = 40;         ///< at each of four places of the plate in its voxels
  std::uint64_t seed = 1;
};
struct StartFigures {
  int runs = 0, placed = 0;
};
StartFigures starts(const StartOptions& options);

/// A hand that goes straight on to one random place after the other, in and out of the cup, and
/// turns.
class TumblingHand {
 public:
  TumblingHand(double speed, double spin, std::uint64_t seed)
      : random_(seed),
        speed_(speed),
        spin_(spin) {}
  const Pose& pose() const noexcept { return pose_; }
  /// Where it is a period later.
  const Pose& next();

 private:
  std::mt19937_64 random_;
  double speed_, spin_;  ///< [m/s], [rad/s]
  Pose pose_{Vec3(0, 0, 0.14), Quat::Identity()};
  Vec3 target_ = Vec3(0, 0, 0.05), axis_ = Vec3::UnitX();
};
/// The box that tumbles.
mesh::TriangleMesh tumbling_box();

/// Ball or box that tumbles in and out of the cup.
struct TumbleOptions {
  std::string scene = "cup";
  bool box = false;
  double edge = 0.002, speed = 1.0, spin = 30.0;
  int frames = 3000;
  std::uint64_t seed = 1;
};
struct TumbleFigures {
  double contact_ratio = 0.0, not_converged_ratio = 0.0, depth_worst = 0.0, queries_mean = 0.0,
         iterations_mean = 0.0;
  int inside = 0, not_exact = 0;
  double frame_us = 0.0, frame_us_999 = 0.0, frame_us_worst = 0.0;
  double energy_given =
      0.0;  ///< most that the virtual tool's own energy rose by while the hand stood [J/k]
};
TumbleFigures tumble(const TumbleOptions& options);

/// The ball over a block's edge, at 50 mm/s.
struct EdgeFigures {
  double step_worst = 0.0, step_over_force = 0.0, force_mean = 0.0, energy = 0.0;
};
EdgeFigures over_edge(double edge, double depth_m, double speed, std::uint64_t seed, int tries);

}  // namespace voxtouch::virtual_tool

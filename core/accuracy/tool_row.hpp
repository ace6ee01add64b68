#pragma once
/// A virtual tool pressed into the places of a measurement; its truth follows the same hand
/// (true_tools.hpp).
#include <cstdint>
#include <functional>
#include <vector>

#include "core/accuracy/contact_places.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::accuracy {

/// Depth of the hand at each place [voxel edges of the setting].
inline constexpr double kHandDepthEdges = 5.0;

/// A frame of a hand that slides in contact.
struct SlideFrame {
  double time_s = 0.0;        ///< CPU time, including the clock call
  std::uint32_t queries = 0;  ///< that the virtual tool made
};

/// Sideways displacement of the hand per frame: 50 mm/s at e = 2 mm and 1 kHz.
inline constexpr double kSlideEdges = 1.0 / 40.0;

/// Moves in by an eighth of a voxel per frame, then rests. It begins one voxel before the touch: a
/// virtual tool needs a free start pose, and at a rim the touch itself may count as inside.
class ToolPress {
 public:
  /// `built` has a virtual tool and must outlive this.
  ToolPress(rendering::BuiltScene& built, double edge_m);

  /// Force at the end, for a spring of 1 N/m.
  Wrench into(const ContactPlace& place, double depth_m);
  /// Frames of a hand that slides across the path in, kSlideEdges of a voxel each, from the end of
  /// `into`. Each frame's time is the least of several runs of the same slide, with bit-identical
  /// results, which excludes interruptions. A hand that moves straight in cannot be timed: the tool
  /// stays at rest and a frame makes no query. `cpu_time_s`: a clock [s]; none: times read 0.
  std::vector<SlideFrame> slide(const ContactPlace& place, double depth_m,
                                const std::function<double()>& cpu_time_s);

 private:
  rendering::SceneFrame at(const Pose& hand, double dt_s);

  rendering::SceneRenderer& renderer_;
  double edge_m_, time_s_ = 0.0;
};

}  // namespace voxtouch::accuracy

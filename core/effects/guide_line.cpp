// A guide to a line: the tool's origin slides freely along it and is constrained across it.
#include <algorithm>

#include "core/effects/guide_law.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kPoint = kGuideOwn, kDirection, kEnds, kHalfLength };
constexpr double kSegment = 1.0;  // index of the word

constexpr auto kParameters =
    guide_rows(row::place("point", "Point of the line, in W [m]; the centre of a segment."),
               row::direction("direction", "Direction of the line, in W. The sign has no effect."),
               row::word("ends", "none segment",
                         "none: an infinite line. segment: at its ends the guide acts as a point."),
               row::number("half_length_m", 0.0, 100.0, 0.0,
                           "With `ends: segment`: from its centre to an end [m]."));

class GuideLine final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const Vec3 from_point = frame.tool.position - values.vector(kPoint),
               along = values.vector(kDirection);
    const Mat3 across = Mat3::Identity() - along * along.transpose();
    if (values.number(kEnds) != kSegment) {
      // A direction that ramps is shorter than 1: `across` then includes a part along the line, up
      // to the force of a point guide.
      pull_to_guide(guide_law(values), across * from_point, across, sum);
      return;
    }
    // During a ramp the segment shrinks with its direction, at most to its centre.
    const double length = along.norm(), half = length * values.number(kHalfLength);
    const Vec3 unit = length > 0.0 ? Vec3(along / length) : Vec3::Zero();
    const double place = unit.dot(from_point), nearest = std::clamp(place, -half, half);
    const bool inside_segment = length > 0.0 && nearest == place;
    pull_to_guide(
        guide_law(values), from_point - nearest * unit,
        inside_segment ? Mat3(Mat3::Identity() - unit * unit.transpose()) : Mat3(Mat3::Identity()),
        sum);
  }
};

std::string check(const EffectValues& values) {
  const bool segment = values.number(kEnds) == kSegment;
  if (segment != (values.number(kHalfLength) > 0.0))
    return segment ? "'ends: segment' requires 'half_length_m' above 0"
                   : "'half_length_m' requires 'ends: segment'";
  return check_guide(values);
}

}  // namespace

extern const EffectKind kGuideLine = {
    .name = "guide_line",
    .summary =
        "Pulls the tool's origin to a line with a limited force. It slides along the line freely.",
    .equations =
        "U = phi(distance to the line or segment), F = -grad U, phi as of guide_point. The "
        "distance to a convex set is "
        "convex, so |dF/dx| <= k around the line and round its ends. Conservative. Stable for k < "
        "b / (T/2 + t_d) "
        "(Colgate and Schenkel 1997), b the damping of hand and device.",
    .energy = EnergyBehaviour::kConservative,
    .parameters = kParameters,
    .bound = guide_bound,
    .check = check,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<GuideLine>()); },
    .expected_ns = 80.0,
};

}  // namespace voxtouch::effects

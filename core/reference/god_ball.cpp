#include "core/reference/god_ball.hpp"

namespace voxtouch::reference {

Vec3 drawn_ball(const ReferenceScene& reference, double radius_m, const Vec3& start,
                const Vec3& hand) {
  constexpr double kStepRatio = 0.02, kEndRatio = 1e-6;  // of the radius
  constexpr int kMaxSteps = 2000, kWalls = 8;
  Vec3 centre = start;
  double step = kStepRatio * radius_m;
  for (int n = 0; n < kMaxSteps && step > kEndRatio * radius_m; ++n) {
    const Vec3 displacement = hand - centre, before = centre;
    centre +=
        displacement.norm() > step ? Vec3(step / displacement.norm() * displacement) : displacement;
    for (int wall = 0; wall < kWalls; ++wall) {
      const Vec3 out = centre - reference.nearest(centre);
      const double gap = out.norm() - radius_m;
      if (!(gap < 0.0))
        break;
      centre -= gap * out.normalized();
    }
    if ((hand - centre).norm() > (hand - before).norm() - 1e-3 * step) {  // no longer approaching:
                                                                          // smaller steps
      if ((hand - centre).norm() > (hand - before).norm())
        centre = before;
      step *= 0.5;
    }
  }
  return centre;
}

}  // namespace voxtouch::reference

#include "tests/experiments/paper/merits.hpp"

#include <cmath>
#include <numbers>

#include "tests/experiments/paper/contact_cases.hpp"

namespace voxtouch::paper {
namespace {

const ContactCase kOriginal{"original", contact::ContactModelKind::kOriginal,
                            contact::PointWeights::kOne},
    kAdapted{"adapted", contact::ContactModelKind::kAdapted, contact::PointWeights::kOne},
    kNaiveOriginal{"naive, original", contact::ContactModelKind::kOriginal,
                   contact::PointWeights::kOne, true};

/// Orientations of the sphere: identity and three others.
std::vector<Quat> turned() {
  return {Quat::Identity(), Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())),
          Quat(Eigen::AngleAxisd(1.1, Vec3(-2, 1, 0.5).normalized())),
          Quat(Eigen::AngleAxisd(2.3, Vec3(0.3, -1, 1).normalized()))};
}

double ratio(const ContactCase& above, const ContactCase& below, const Slide& slide,
             const Ground& ground, const Sphere& sphere, int steps, bool about_mean = false) {
  const Distraction a = distraction(renderer_of(above, ground, sphere), slide, steps),
                    b = distraction(renderer_of(below, ground, sphere), slide, steps);
  return about_mean ? a.rms_about_mean / b.rms_about_mean : a.rms / b.rms;
}

Quat tilt(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

/// Ratios over a list of settings.
class Ratios {
 public:
  void add(double value) {
    if (std::isfinite(value))
      values_.push_back(value);  // no force in either: this depth is above the layer's centre
  }
  Merit merit(const std::string& what, double reference, const std::string& conditions) const {
    return {what,
            test::quantile(values_, 0.5),
            test::quantile(values_, 0.0),
            test::quantile(values_, 1.0),
            reference,
            conditions};
  }

 private:
  std::vector<double> values_;
};

constexpr double kDepths[] = {0.25, 0.5, 0.75};

struct PlaneRatios {
  Ratios aligned, aligned_about, tilted;
};

void on_planes(const Sphere& sphere, int steps, PlaneRatios& out) {
  for (const double depth : kDepths) {
    for (const double up : {0.6, 0.75, 0.9}) {
      const Slide s = circle_on_plane("aligned", Quat::Identity(), up, depth, Quat::Identity());
      const Ground ground(s.mesh);
      out.aligned.add(ratio(kAdapted, kOriginal, s, ground, sphere, steps));
      out.aligned_about.add(ratio(kAdapted, kOriginal, s, ground, sphere, steps, true));
    }
    for (const Quat& turn :
         {tilt(15, Vec3(1, 0.3, 0)), tilt(26.6, Vec3::UnitX()), tilt(34, Vec3(1, 2, 0.5))}) {
      const Slide s = circle_on_plane("tilted", turn, 0.3, depth, Quat::Identity());
      const Ground ground(s.mesh);
      out.tilted.add(ratio(kAdapted, kOriginal, s, ground, sphere, steps));
    }
  }
}

struct CylinderRatios {
  Ratios exact, naive_still, naive_turned;
};

void round_cylinders(const Sphere& sphere, int steps, CylinderRatios& out) {
  for (const double radius : {10.0 * kEdge, 20.0 * kEdge}) {
    const Ground ground(round_a_cylinder(radius, 0.5, Quat::Identity(), 0.0007).mesh);
    for (const double depth : kDepths)
      for (const Quat& turn : turned()) {
        const bool still = turn.vec().isZero(0.0);
        const Slide s = round_a_cylinder(radius, depth, turn, 0.0007);
        out.exact.add(ratio(kAdapted, kOriginal, s, ground, sphere, steps));
        (still ? out.naive_still : out.naive_turned)
            .add(ratio(kAdapted, kNaiveOriginal, s, ground, sphere, steps));
      }
  }
}

}  // namespace

std::vector<Merit> contact_merits(int steps) {
  const Sphere askew, symmetric(Vec3::Zero());
  PlaneRatios planes;
  on_planes(askew, steps, planes);
  CylinderRatios cylinders;
  for (const Sphere* sphere : {&askew, &symmetric})
    round_cylinders(*sphere, steps, cylinders);
  const std::string plane = "depth 0.25, 0.5, 0.75 e; ",
                    round =
                        "depth 0.25, 0.5, 0.75 e, radius 10 and 20 e, sphere's centre on a corner "
                        "of its voxels and askew";
  return {planes.aligned.merit("plane along the grid: adapted over original", 0.47,
                               plane + "face 0.6, 0.75, 0.9 up its voxel. All of adapted's "
                                       "distraction is constant here: it is what the shell's "
                                       "points "
                                       "sum up to, and 0 for a sphere that lies symmetric in its "
                                       "voxels; so the ratio hangs on where it lies"),
          planes.aligned_about.merit("plane along the grid, about its mean", 0.0, "the same"),
          planes.tilted.merit("tilted plane: adapted over original", 0.62,
                              plane + "15, 26.6 and 34 degrees"),
          cylinders.exact.merit("cylinder: adapted over original", 0.58,
                                round + ", sphere turned four ways"),
          cylinders.naive_still.merit(
              "cylinder, sphere not turned: exact and adapted over naive and original", 0.27,
              round + ". The naive shell's steps line up with the wall's only where the sphere "
                      "lies symmetric (0.23), askew they do not (0.37)"),
          cylinders.naive_turned.merit(
              "cylinder, sphere turned: exact and adapted over naive and original", 0.56,
              round + ", turned three ways; falls with the depth: 0.6 at 0.25 e, 0.75 at 0.75 e")};
}

}  // namespace voxtouch::paper

#include "core/accuracy/contact_places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "core/reference/reference_mesh.hpp"
#include "core/reference/reference_scene.hpp"

namespace voxtouch::accuracy {
namespace {

constexpr int kAttemptsPerPlace = 20;
constexpr int kMaxSteps = 80;
constexpr double kTouchRatio = 1e-7;  ///< of the tool's reach: a gap this small is a touch
constexpr double kClear = 1.02;       ///< the tool starts this many reaches away

/// The same numbers with every standard library.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// Shoemake 1992: uniform over all rotations.
  Quat rotation() {
    const double u = uniform(), a = 2.0 * std::numbers::pi * uniform(),
                 b = 2.0 * std::numbers::pi * uniform();
    const double s = std::sqrt(1.0 - u), t = std::sqrt(u);
    return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
  }

 private:
  std::mt19937_64 engine_;
};

/// The static surface, to be hit area for area.
class Surface {
 public:
  explicit Surface(const scene::Scene& scene) {
    for (const scene::MeshSpec& spec : scene.static_meshes) {
      const reference::ReferenceMesh mesh = reference::read_reference_mesh(spec);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        triangles_.push_back({spec.pose * mesh.corner(t, 0), spec.pose * mesh.corner(t, 1),
                              spec.pose * mesh.corner(t, 2)});
        area_ += 0.5 * normal(triangles_.back()).norm();
        sums_.push_back(area_);
      }
    }
  }
  struct Aim {
    Vec3 point, normal;
  };
  Aim aim(RandomNumbers& random) const {
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), area_ * random.uniform());
    const Triangle& t =
        triangles_[static_cast<std::size_t>(std::min(found, sums_.end() - 1) - sums_.begin())];
    const double r = std::sqrt(random.uniform()), v = random.uniform();
    return {(1.0 - r) * t[0] + r * (1.0 - v) * t[1] + r * v * t[2], normal(t).normalized()};
  }

 private:
  using Triangle = std::array<Vec3, 3>;
  static Vec3 normal(const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

  std::vector<Triangle> triangles_;
  std::vector<double> sums_;
  double area_ = 0.0;
};

/// Middle of the tool's box and the ball round it, in T.
struct Tool {
  explicit Tool(const scene::Scene& scene) {
    const reference::ReferenceMesh mesh = reference::read_reference_mesh(scene.dynamic_mesh);
    const Pose& pose = scene.dynamic_mesh.pose;
    Vec3 low = pose * mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices)
      low = low.cwiseMin(pose * v), high = high.cwiseMax(pose * v);
    centre = 0.5 * (low + high);
    for (const Vec3& v : mesh.vertices)
      reach = std::max(reach, (pose * v - centre).norm());
  }
  Vec3 centre = Vec3::Zero();
  double reach = 0.0;
};

/// Moves on by the gap, which no step can jump, until the tool touches.
std::optional<ContactPlace> approach(const reference::ReferenceScene& reference, const Tool& tool,
                                     const Surface::Aim& aim, const Quat& rotation) {
  ContactPlace place;
  place.into = -aim.normal;
  place.touch.orientation = rotation;
  place.touch.position = aim.point + kClear * tool.reach * aim.normal - rotation * tool.centre;
  double gap = reference.apart_m(place.touch), gone = 0.0;
  if (!(gap > 0.0) || !(reference.gap(place.touch).gap_m > 0.0))
    return std::nullopt;  // another surface is in the path
  for (int n = 0; n < kMaxSteps && gone <= 2.0 * kClear * tool.reach; ++n) {
    if (gap <= kTouchRatio * tool.reach)
      return place;
    place.touch.position += gap * place.into;
    gone += gap;
    const double left = reference.apart_m(place.touch);
    if (!(left > 0.0))
      return place;  // by rounding: the step was the gap itself
    gap = left;
  }
  return std::nullopt;
}

}  // namespace

std::vector<ContactPlace> contact_places(const scene::Scene& scene, std::uint32_t count,
                                         std::uint64_t seed,
                                         const std::function<void(double fraction)>& progress) {
  scene::Scene by_triangles = scene;  // contact models use the triangles, not the primitives
  by_triangles.dynamic_mesh.primitives.clear();
  for (scene::MeshSpec& mesh : by_triangles.static_meshes)
    mesh.primitives.clear();
  const reference::ReferenceScene reference(by_triangles);
  const Surface surface(scene);
  const Tool tool(scene);
  RandomNumbers random(seed);
  std::vector<ContactPlace> places;
  for (std::uint32_t attempt = 0; attempt < kAttemptsPerPlace * count && places.size() < count;
       ++attempt) {
    const Surface::Aim aim = surface.aim(random);
    const Quat rotation = random.rotation();
    if (const auto place = approach(reference, tool, aim, rotation))
      places.push_back(*place);
    if (progress)
      progress(std::max(
          static_cast<double>(places.size()) / count,
          static_cast<double>(attempt) / (kAttemptsPerPlace * static_cast<double>(count))));
  }
  return places;
}

}  // namespace voxtouch::accuracy

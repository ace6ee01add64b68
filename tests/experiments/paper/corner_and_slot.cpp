#include <random>

#include "tests/experiments/paper/experiments.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::paper {
namespace {

constexpr double kDepth = 0.5 * kEdge;
constexpr int kGrounds = 5, kPoses = 30;

struct Sums {
  double corner = 0.0, walls = 0.0, slot_squares = 0.0, wall = 0.0;
};

std::vector<Wrench> forces(const ContactCase& contact_case, const Ground& ground,
                           const Sphere& sphere, const std::vector<Pose>& poses) {
  contact::ContactRenderer renderer = renderer_of(contact_case, ground, sphere);
  std::vector<Wrench> out;
  for (const Pose& pose : poses)
    out.push_back(renderer.probe(pose).wrench);
  return out;
}

Vec3 mean(const std::vector<Wrench>& wrenches) {
  Vec3 sum = Vec3::Zero();
  for (const Wrench& w : wrenches)
    sum += w.force / static_cast<double>(wrenches.size());
  return sum;
}

}  // namespace

std::vector<CornerAndSlot> corner_and_slot(std::uint64_t seed) {
  const Sphere sphere;
  const std::vector<ContactCase> contact_cases = all_contact_cases();
  std::vector<Sums> sums(contact_cases.size());
  std::mt19937_64 random(seed);
  for (int n = 0; n < kGrounds; ++n) {
    const auto shift = [&] { return test::uniform(random, 0, kEdge); };
    const Pose at{Vec3(shift(), shift(), shift()), test::random_rotation(random)};
    const auto box = [&](const Vec3& size, const Vec3& where) {
      return test::box_mesh(size, at * Pose{where, Quat::Identity()});
    };
    const auto inside = [](double side) { return Vec3(side * (kRadius - kDepth + 0.02), 0, 0); };
    const mesh::TriangleMesh left = box({0.04, 0.12, 0.12}, {-0.02, 0, 0}),
                             below = box({0.12, 0.04, 0.12}, {0, -0.02, 0}),
                             one = box({0.04, 0.12, 0.12}, inside(1)),
                             other = box({0.04, 0.12, 0.12}, inside(-1));
    const Ground corner(test::joined(left, below)), wall_left(left), wall_below(below),
        slot(test::joined(one, other)), wall(one);
    std::vector<Pose> in_corner, in_slot;
    for (int m = 0; m < kPoses; ++m) {
      const auto along = [&] { return test::uniform(random, -0.01, 0.01); };
      in_corner.push_back(
          {at * Vec3(kRadius - kDepth, kRadius - kDepth, along()), test::random_rotation(random)});
      in_slot.push_back({at * Vec3(0, along(), along()), test::random_rotation(random)});
    }
    for (std::size_t k = 0; k < contact_cases.size(); ++k) {
      Sums& s = sums[k];
      s.corner += mean(forces(contact_cases[k], corner, sphere, in_corner)).norm();
      s.walls += (mean(forces(contact_cases[k], wall_left, sphere, in_corner)) +
                  mean(forces(contact_cases[k], wall_below, sphere, in_corner)))
                     .norm();
      for (const Wrench& w : forces(contact_cases[k], slot, sphere, in_slot))
        s.slot_squares += w.force.squaredNorm() / (kGrounds * kPoses);
      for (const Wrench& w : forces(contact_cases[k], wall, sphere, in_slot))
        s.wall += w.force.norm() / (kGrounds * kPoses);
    }
  }
  std::vector<CornerAndSlot> out;
  for (std::size_t k = 0; k < contact_cases.size(); ++k)
    out.push_back({contact_cases[k].name, sums[k].corner / sums[k].walls,
                   std::sqrt(sums[k].slot_squares) / sums[k].wall});
  return out;
}

}  // namespace voxtouch::paper

// Several closed meshes that touch or overlap are one solid.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/hard/faults/inputs.hpp"

namespace voxtouch::faults {
namespace {

const Box kFloor{{-0.06, -0.04, -0.03}, {0.06, 0.04, 0.0}};
const std::string kField = "contact: {model: field, stiffness_n_per_m3: 3.0e6}\n";
const std::string kAdapted = "contact: {model: adapted, stiffness_n_per_m: 30}\n";

std::vector<Box> tiles(double overlap_m) {
  std::vector<Box> out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 4; ++j)
      out.push_back({{-0.06 + 0.02 * i, -0.04 + 0.02 * j, -0.03},
                     {std::min(-0.04 + 0.02 * i + overlap_m, 0.06),
                      std::min(-0.02 + 0.02 * j + overlap_m, 0.04), 0.0}});
  return out;
}

std::unique_ptr<rendering::BuiltScene> built(const std::filesystem::path& file) {
  return rendering::build_scene(scene::load_scene(file), serial_for());
}

Wrench contact(rendering::BuiltScene& scene, const Vec3& at) {
  std::vector<std::uint32_t> hits;
  return scene.contacts().probe({at, Quat::Identity()}, hits).wrench;
}

/// Every third millimetre over the seams, 3 and 6 mm deep: within 1 % of the floor of one box.
void expect_as_one(rendering::BuiltScene& one, rendering::BuiltScene& other,
                   const std::string& name) {
  double worst = 0.0;
  for (const double depth : {0.003, 0.006})
    for (int n = -10; n <= 10; ++n) {
      const Vec3 at(0.003 * n, 0.004 + 0.0001 * n, 0.01 - depth);
      const Vec3 right = contact(one, at).force;
      worst = std::max(worst, (contact(other, at).force - right).norm() / right.norm());
    }
  EXPECT_LT(worst, 0.01) << name;
}

class Seams : public testing::TestWithParam<std::string> {};

TEST_P(Seams, BoxesInOneFileActAsOne) {
  Inputs inputs;
  inputs.mesh("one", {kFloor});
  inputs.mesh("touch", {{kFloor.low, {0, 0.04, 0}}, {{0, -0.04, -0.03}, kFloor.high}});
  inputs.mesh("tiles", tiles(0.0));
  inputs.mesh("overlap", tiles(0.007));
  inputs.mesh("nested", {kFloor, {{-0.02, -0.02, -0.025}, {0.02, 0.02, -0.002}}});
  inputs.mesh("flush", {kFloor, {{-0.02, -0.02, -0.015}, {0.02, 0.02, 0.0}}});
  const auto scene = [&](const std::string& mesh) {
    return built(inputs.scene(mesh, "static: [{mesh: " + mesh + ".obj}]\n" + ball() + GetParam()));
  };
  const auto one = scene("one");
  for (const char* name : {"touch", "tiles", "overlap", "nested", "flush"})
    expect_as_one(*one, *scene(name), name);
}

TEST_P(Seams, AdjacentFilesActAsOne) {
  Inputs inputs;
  inputs.mesh("one", {kFloor});
  inputs.mesh("left", {{kFloor.low, {0.0051, 0.04, 0}}});
  inputs.mesh("right", {{{0.0, -0.04, -0.03}, kFloor.high}});
  const auto one = built(inputs.scene("one", "static: [{mesh: one.obj}]\n" + ball() + GetParam()));
  const auto two = built(
      inputs.scene("two", "static: [{mesh: left.obj}, {mesh: right.obj}]\n" + ball() + GetParam()));
  expect_as_one(*one, *two, "files");
}

/// The floor of one box, and the same of a ground and two objects at rest.
struct Floors {
  Inputs inputs;
  std::unique_ptr<rendering::BuiltScene> one, three;
};

Floors floors(const std::string& contact) {
  Floors made;
  Inputs& inputs = made.inputs;
  inputs.mesh("one", {kFloor});
  inputs.mesh("left", {{kFloor.low, {0, 0.04, 0}}});
  inputs.mesh("right", {{{-0.0041, -0.04, -0.03}, kFloor.high}});
  inputs.mesh("inlay", {{{0.01, -0.02, -0.01}, {0.02, 0.02, 0.0}}});
  made.one = built(inputs.scene("one", "static: [{mesh: one.obj}]\n" + ball() + contact));
  made.three =
      built(inputs.scene("three",
                         "static: [{mesh: left.obj}, {mesh: right.obj, object: {name: east}}, "
                         "{mesh: inlay.obj, object: {name: inlay}}]\n" +
                             ball() + contact));
  return made;
}

class SeamsOfObjects : public testing::TestWithParam<std::string> {};

TEST_P(SeamsOfObjects, AtRestActAsOneObject) {
  const Floors made = floors(GetParam());
  expect_as_one(*made.one, *made.three, "objects");
}

/// In, along and out again in steps of 0.1 mm: points that passed through in one object stay
/// latched in the next.
TEST_P(SeamsOfObjects, UnderASlidingToolActAsOneObject) {
  const Floors made = floors(GetParam());
  double worst = 0.0, largest = 0.0;
  const auto step = [&](const Vec3& at) {
    const Vec3 right =
        made.one->contacts().render({at, Quat::Identity()}, 0.0).contact.wrench.force;
    const Vec3 reported =
        made.three->contacts().render({at, Quat::Identity()}, 0.0).contact.wrench.force;
    largest = std::max(largest, right.norm());
    worst = std::max(worst, (reported - right).norm() / std::max(right.norm(), 0.1));
  };
  for (int n = 0; n <= 60; ++n)
    step({-0.03, 0.004, 0.01 - 0.0001 * n});
  for (int n = 0; n <= 600; ++n)
    step({-0.03 + 0.0001 * n, 0.004 + 0.00001 * n, 0.004});
  for (int n = 0; n <= 60; ++n)
    step({0.03 - 0.0003 * n, 0.01, 0.004 + 0.0001 * n});
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(largest, 1.0);
}

const std::string kOriginal = "contact: {model: original, stiffness_n_per_m: 30}\n";

INSTANTIATE_TEST_SUITE_P(Models, Seams, testing::Values(kField, kAdapted));
INSTANTIATE_TEST_SUITE_P(Models, SeamsOfObjects, testing::Values(kField, kAdapted, kOriginal));

}  // namespace
}  // namespace voxtouch::faults

// A scene's time budget: how it becomes counts, what it refuses, what the plan says of it, and that
// it is judged at a reload as at the start.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cstring>
#include <thread>

#include "core/rendering/live_scene.hpp"
#include "core/rendering/time_budget.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering::budget_scene {
namespace {

scene::Scene scene_of(const std::string& more,
                      const std::string& contact = "{stiffness_n_per_m: 10}") {
  return scene::parse_scene(
      "scene: budget\nvoxel_size: 0.0005\nstatic: [{mesh: plane.obj}]\ndynamic: {mesh: sphere.obj, "
      "scale: 0.01}\ncontact: " +
          contact + "\n" + more,
      std::string(VOXTOUCH_DEPLOY) + "/meshes/test.yaml");
}

/// The ball's radius is 10 mm; the block's top is z = 0.
ToolState at(double z) {
  ToolState tool;
  tool.pose.position = Vec3(0.003, 0.002, z);
  return tool;
}

bool has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

std::string refusal_of(const scene::Scene& scene) {
  try {
    (void)build_scene(scene, serial_for());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(BudgetScene, WithoutABudgetIsBuiltAsEver) {
  const auto built = build_scene(scene_of(""), serial_for());
  EXPECT_TRUE(built->renderer().query().levels().empty());
  EXPECT_EQ(built->plan().budget_us, 0.0);
  EXPECT_FALSE(has(built->plan().built, "budget"));
}

TEST(BudgetScene, BecomesACountOfPointsThatNoFrameExceeds) {
  const scene::Scene scene = scene_of("budget_us: 50\n");
  const auto built = build_scene(scene, serial_for());
  const std::size_t shell = built->renderer().query().shell().size();
  const std::uint32_t points = points_within(50.0, scene, {.shell_points = shell});
  const std::uint32_t twice = points_within(100.0, scene, {.shell_points = shell});
  EXPECT_GT(twice, 2 * points) << "what a frame takes beside its points is taken once";
  EXPECT_LT(points_within(100.0, scene, {.objects = 2, .shell_points = shell}), twice / 2)
      << "and once for each object";
  EXPECT_EQ(built->plan().budget_points, points);
  EXPECT_TRUE(has(built->plan().built, "of 50 us") &&
              has(built->plan().built, " " + std::to_string(points) + " points"));
  LiveScene live(*built);
  std::uint32_t most = 0, left_out = 0;
  double time_s = 0.0;
  for (double z = 0.0105; z > 0.004; z -= 2e-5) {
    const SceneFrame frame = live.render(at(z), time_s += 1e-3);
    most = std::max(most, frame.touch.contact.points_tested);
    left_out = std::max(left_out, frame.touch.contact.left_out.points);
    const double stiffest =
        Eigen::SelfAdjointEigenSolver<Mat3>(frame.stiffness.topLeftCorner<3, 3>()).eigenvalues()[2];
    ASSERT_LE(stiffest, built->plan().contact_n_per_m.all_points);
    ASSERT_LE(frame.stiffness_bound_n_per_m,
              built->plan().contact_n_per_m.all_points * (1 + 1e-12));
    const double turns =
        Eigen::SelfAdjointEigenSolver<Mat3>(frame.stiffness.bottomRightCorner<3, 3>())
            .eigenvalues()[2];
    ASSERT_LE(turns, built->plan().contact_nm_per_rad.all_points);
  }
  EXPECT_LE(most, points);
  EXPECT_GT(left_out, 0U);
}

TEST(BudgetScene, GivesTheSameBitsWithAnyNumberOfThreads) {
  const scene::Scene scene = scene_of("budget_us: 50\n");
  const ParallelFor two = [](std::size_t count, const std::function<void(std::size_t)>& job) {
    std::thread other([&] {
      for (std::size_t n = 1; n < count; n += 2)
        job(n);
    });
    for (std::size_t n = 0; n < count; n += 2)
      job(n);
    other.join();
  };
  const auto one = build_scene(scene, serial_for()), many = build_scene(scene, two);
  LiveScene a(*one), b(*many);
  double time_s = 0.0;
  for (double z = 0.0105; z > 0.005; z -= 2e-5) {
    time_s += 1e-3;
    const SceneFrame x = a.render(at(z), time_s), y = b.render(at(z), time_s);
    ASSERT_EQ(std::memcmp(x.wrench.force.data(), y.wrench.force.data(), 3 * sizeof(double)), 0)
        << z;
    ASSERT_EQ(x.touch.contact.left_out.points, y.touch.contact.left_out.points);
  }
}

TEST(BudgetScene, OfAHeavierCoarsestPointIsWhatACouplingIsFittedFor) {
  const auto cut = build_scene(scene_of("budget_us: 40\n"), serial_for()),
             whole = build_scene(scene_of(""), serial_for());
  EXPECT_GT(cut->plan().contact_n_per_m.one_point, 10.0 * whole->plan().contact_n_per_m.one_point);
  EXPECT_NEAR(cut->plan().contact_n_per_m.all_points, whole->plan().contact_n_per_m.all_points,
              1e-9 * whole->plan().contact_n_per_m.all_points);
  EXPECT_GE(cut->plan().contact_nm_per_rad.all_points, whole->plan().contact_nm_per_rad.all_points);
}

/// A reload builds the scene by the same function: what is refused at the start is refused then, in
/// the same words.
TEST(BudgetScene, IsRefusedWhereItIsTooLittleAndNamesTheLeast) {
  const std::string text = refusal_of(scene_of("budget_us: 5\n"));
  EXPECT_NE(text.find("'budget_us' is 5"), std::string::npos) << text;
  const std::size_t place = text.find("Say at least ");
  ASSERT_NE(place, std::string::npos) << text;
  const std::string least = text.substr(place + 13, text.find(',', place) - place - 13);
  EXPECT_EQ(refusal_of(scene_of("budget_us: " + least + "\n")), "");
  EXPECT_NE(refusal_of(scene_of("budget_us: " + std::to_string(std::stod(least) - 1.0) + "\n")),
            "");
  // Effects have their time too, also those that are off; of two objects each has half of the
  // points.
  const FrameWork work{.shell_points = 100'000};
  const std::uint32_t alone = points_within(60.0, scene_of(""), work);
  EXPECT_LT(points_within(
                60.0, scene_of("effects: [{viscosity: {damping_ns_per_m: 1}, on: false}]\n"), work),
            alone);
  EXPECT_LE(points_within(120.0, scene_of(""), {.objects = 2, .shell_points = 100'000}), alone);
}

TEST(BudgetScene, SaysThatNothingIsLeftOutWhereTheTimeIsEnough) {
  const auto built = build_scene(scene_of("budget_us: 100000\n"), serial_for());
  EXPECT_TRUE(built->renderer().query().levels().empty());
  EXPECT_EQ(built->plan().budget_points, 0U);
}

TEST(BudgetScene, OfAVirtualToolLeavesOutNoPointAndSaysWhenItIsNotKept) {
  const std::string tool = "{rendering: virtual_tool}";
  const auto built =
      build_scene(scene_of("coupling: {design: auto}\nbudget_us: 30\n", tool), serial_for());
  EXPECT_TRUE(built->renderer().query().levels().empty());
  EXPECT_EQ(built->plan().budget_points, 0U);
  EXPECT_TRUE(has(built->plan().warnings, "not kept"));
  const auto rich =
      build_scene(scene_of("coupling: {design: auto}\nbudget_us: 100000\n", tool), serial_for());
  EXPECT_FALSE(has(rich->plan().warnings, "not kept"));
  // With time for no more than it always makes, a fast press ends its frames early; it comes to the
  // same place.
  LiveScene cut(*built), whole(*rich);
  for (LiveScene* live : {&cut, &whole})
    live->aim_for_spring(300.0);
  double time_s = 0.0;
  int cut_short = 0;
  SceneFrame x, y;
  const auto step = [&](double z) {
    time_s += 1e-3;
    x = cut.render(at(z), time_s), y = whole.render(at(z), time_s);
    cut_short += x.tool.cut_short;
    ASSERT_FALSE(y.tool.cut_short);
    ASSERT_LE(x.tool.queries, 5U);
    ASSERT_EQ(x.touch.contact.left_out.points, 0U);
  };
  for (int n = 0; n < 250; ++n)
    step(0.013);
  for (double z = 0.013; z > 0.002; z -= 2e-3)
    step(z);
  for (int n = 0; n < 50; ++n)
    step(0.002);
  EXPECT_GT(cut_short, 0);
  EXPECT_NEAR(x.wrench.force.z(), y.wrench.force.z(), 1e-3);
}

}  // namespace
}  // namespace voxtouch::rendering::budget_scene

// Each change that is told, read off the sentence, made to the scene, and felt: it gives at least
// the force that was promised.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <regex>

#include "core/felt/felt.hpp"
#include "core/scene/device_file.hpp"
#include "core/scene/scene_file.hpp"
#include "devices/registry.hpp"

namespace voxtouch::felt {
namespace changes_test {

coupling::design::DeviceModel device_of(const std::string& name) {
  if (name.starts_with("sim-"))
    return coupling::design::model_of(devices::describe_device(name));
  return coupling::design::model_of(
      scene::load_device_file(std::string(VOXTOUCH_DEPLOY) + "/devices/" + name + ".yaml")
          .description);
}

scene::Scene scene_of(const std::string& name, const std::string& kind = "") {
  scene::Scene scene =
      scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml");
  if (!kind.empty())
    scene.design->kind = kind;
  return scene;
}

struct Situation {
  scene::Scene scene;
  coupling::design::DeviceModel device;
  std::unique_ptr<rendering::BuiltScene> built = rendering::build_scene(
      scene, [](std::size_t count, const std::function<void(std::size_t)>& body) {
        for (std::size_t i = 0; i < count; ++i)
          body(i);
      });
  Felt felt{scene, device, built->plan().of_contact_alone,
            fitting::fit_coupling(scene, device, built->plan().contact_n_per_m,
                                  built->plan().contact_nm_per_rad)};

  std::string sentence(Search search = Search::kAll) {
    return felt_sentence(felt.fitted, scene, device, *built, "", search);
  }
  /// 10 mm deep where the first motion that touches does so: of a virtual tool, too, by its frames.
  /// Of a body its grip.
  double force() {
    for (const auto& [name, motion] : scene.motions)
      if (const std::vector<Pressed> pressed = press(*built, scene, felt.fitted, device, motion);
          !pressed.empty())
        return pressed.back().force_n;
    return force_n(felt, *built, nullptr);
  }
};

struct Told {
  std::string what;
  double force_n;
};
std::vector<Told> told_in(const std::string& sentence) {
  static const std::regex one(R"( (?:More|Or): (.+?) gives ([0-9.e+]+) N\.)");
  std::vector<Told> out;
  for (auto it = std::sregex_iterator(sentence.begin(), sentence.end(), one);
       it != std::sregex_iterator(); ++it)
    out.push_back({(*it)[1], std::stod((*it)[2])});
  return out;
}

/// What a person would do who reads it. False: it says nothing that one can do.
bool made(const std::string& what, scene::Scene& scene, coupling::design::DeviceModel& device) {
  const auto begins = [&](const char* with) { return what.starts_with(with); };
  const auto number = [&] { return std::stod(what.substr(what.find(": ") + 2)); };
  if (begins("coupling.kind: direct"))
    return scene.design->kind = "direct", true;
  if (begins("coupling.damping_floor: 0,"))
    return scene.design->damping_floor = 0.0, true;
  if (begins("coupling.damper_share: 0,"))
    return scene.design->damper_share = 0.0, true;
  if (begins("coupling.released: false,"))
    return scene.design->released = false, true;
  if (begins("contact: {model: field, rendering: virtual_tool}"))
    return scene.contact = {.model = "field", .rendering = scene::RenderingKind::kVirtualTool},
           true;
  if (begins("contact.stiffness_n_per_m: "))
    return scene.contact.stiffness_n_per_m = number(), true;
  if (begins("contact.stiffness_n_per_m3: "))
    return scene.contact.stiffness_n_per_m3 = number(), true;
  if (begins("device.force_scale: "))
    return scene.device.force_scale = number(), true;
  if (begins("tool.lever_m: "))
    return scene.lever_m = number(), true;
  if (begins("a delay of "))
    return device.timing.delay_s = 1e-3 * std::stod(what.substr(11)), true;
  if (begins("a rate of "))
    return device.timing.period_s = 1.0 / std::stod(what.substr(10)), true;
  if (!begins("body.grip_n_per_m: "))
    return false;
  for (effects::EffectSpec& effect : scene.effects)
    for (std::size_t p = 0; p < effect.values.size(); ++p)
      if (effect.kind->parameters[p].name == "grip_n_per_m")
        return effect.values.at(p)[0] = number(), true;
  return false;
}

struct Case {
  const char *scene, *device, *kind;
  std::size_t told;  ///< how many changes
};
constexpr Case kCases[] = {
    {"cup_virtual_tool", "sim-phantom", "", 1},
    {"cup_virtual_tool", "sim-lwr", "", 1},
    {"cup_virtual_tool", "fr3", "", 2},
    {"cup_virtual_tool", "premium_3", "", 2},
    {"cup_virtual_tool", "inverse3", "", 2},
    {"cup_virtual_tool", "iiwa_7", "", 2},
    {"cup_virtual_tool", "sim-phantom", "auto", 1},
    {"cup_virtual_tool", "sim-lwr", "auto", 0},
    {"cup_virtual_tool", "fr3", "auto", 1},
    {"cup_virtual_tool", "premium_3", "auto", 2},
    {"cup_virtual_tool", "inverse3", "auto", 2},
    {"cup_virtual_tool", "touch", "", 1},
    {"cup_field", "sim-phantom", "", 2},
    {"cup_field", "sim-lwr", "", 2},
    {"plane", "sim-phantom", "", 1},
    {"plane", "premium_3", "", 2},
    {"cup", "inverse3", "", 2},
    {"block", "sim-phantom", "", 1},
    {"block", "sim-lwr", "", 2},
    {"block", "premium_3", "", 0},
};

TEST(Changes, GiveAtLeastTheForceThatIsPromisedAndAreTwoWhereLittleIsFelt) {
  for (const Case& c : kCases) {
    const std::string where = fmt::format("{} on {} {}", c.scene, c.device, c.kind);
    Situation now{scene_of(c.scene, c.kind), device_of(c.device)};
    ASSERT_EQ(now.felt.fitted.refusal, "") << where;
    const std::string sentence = now.sentence();
    const std::vector<Told> told = told_in(sentence);
    EXPECT_EQ(told.size(), c.told) << where << ": " << sentence;
    EXPECT_NE(sentence.find(" What limits it: "), std::string::npos) << where << ": " << sentence;
    if (told.size() < 2 && now.force() < 0.2 * now.device.translation.max_effort) {
      EXPECT_NE(sentence.find(told.empty() ? "no single change" : "o other single change"),
                std::string::npos)
          << where << ": " << sentence;
    }
    double before = 1e9;
    for (const Told& t : told) {
      scene::Scene scene = now.scene;
      coupling::design::DeviceModel device = now.device;
      ASSERT_TRUE(made(t.what, scene, device)) << t.what;
      Situation changed{scene, device};
      EXPECT_EQ(changed.felt.fitted.refusal, "") << where << ", " << t.what;
      const double felt = changed.force();
      std::printf("%s, %s: %.4g N promised, %.4g N felt, %.4g N before\n", where.c_str(),
                  t.what.c_str(), t.force_n, felt, now.force());
      EXPECT_GE(felt, 0.97 * t.force_n)
          << where << ", " << t.what << ": where the hand touches first is known to some 0.1 mm";
      EXPECT_LE(felt, 1.05 * t.force_n)
          << where << ", " << t.what << ": nor is less told than is felt";
      EXPECT_GE(t.force_n, 1.09 * now.force()) << where << ", " << t.what;
      EXPECT_LE(t.force_n, before) << where << ": the best first";
      before = t.force_n;
    }
  }
}

/// Sought in the start's way: nothing is told that is not true, and two changes where little is
/// felt.
TEST(Changes, ThatAStartTellsAreTrueToo) {
  for (const Case& c : {Case{"cup_virtual_tool", "fr3", "", 2},
                        {"cup_virtual_tool", "omega_3", "", 1},
                        {"cup", "sim-phantom", "", 1},
                        {"cup_field", "sim-phantom", "", 2}}) {
    Situation now{scene_of(c.scene, c.kind), device_of(c.device)};
    const std::vector<Told> told = told_in(now.sentence(Search::kKnown));
    EXPECT_EQ(told.size(), c.told) << c.scene << " " << c.device;
    for (const Told& t : told) {
      scene::Scene scene = now.scene;
      coupling::design::DeviceModel device = now.device;
      ASSERT_TRUE(made(t.what, scene, device)) << t.what;
      Situation changed{scene, device};
      EXPECT_GE(changed.force(), 0.97 * t.force_n) << c.scene << " " << c.device << ", " << t.what;
    }
  }
  Situation demo{scene_of("cup_virtual_tool"), device_of("sim-phantom")};
  EXPECT_NE(demo.sentence(Search::kKnown).find("voxtouch plan"), std::string::npos)
      << "what it does not know it does not tell";
}

/// With `kind: auto` the filter left out is no limit, nor is damping that helps.
TEST(Felt, TellsALimitFirstOnEachShippedDevice) {
  for (const char* name : {"sim-phantom", "sim-lwr", "touch", "touch_x", "sigma_7", "fr3",
                           "inverse3", "virtuose_6d", "delta_6"}) {
    Situation now{scene_of("cup_virtual_tool", "auto"), device_of(name)};
    const std::string limit = limit_of(now.felt.fitted, now.device, stiffness_n_per_m(now.felt),
                                       force_n(now.felt, *now.built, nullptr));
    bool is_limit = false;
    for (const char* part : {"becomes unstable at", "the device's force.", "stably.",
                             "That swings die out takes", "more would swing longer", "turning,"})
      is_limit = is_limit || limit.find(part) != std::string::npos;
    EXPECT_TRUE(is_limit) << name << ": " << limit;
    EXPECT_EQ(limit.find("Without the shaping filter"), std::string::npos) << name << ": " << limit;
  }
}

}  // namespace changes_test
}  // namespace voxtouch::felt

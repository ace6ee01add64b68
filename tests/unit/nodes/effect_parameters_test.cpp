// The scene's effects as parameters: every row of every kind, and the request made by setting one.
#include "nodes/rendering/effect_parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/scene/scene_file.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

std::vector<effects::EffectSpec> one_of_each_kind() {
  std::vector<effects::EffectSpec> all;
  for (const effects::EffectKind* kind : effects::effect_kinds()) {
    effects::EffectSpec spec{.name = std::string(kind->name),
                             .kind = kind,
                             .values = effects::EffectValues(kind->parameters),
                             .region = {}};
    for (std::size_t n = 0; n < spec.values.size(); ++n)
      for (double& number : spec.values.at(n))
        if (!std::isfinite(number))
          number = kind->parameters[n].low;
    all.push_back(std::move(spec));
  }
  return all;
}

class EffectParameters : public ::testing::Test {
 protected:
  std::expected<ParameterChange, std::string> set(
      const std::string& name, std::uint8_t type,
      const std::function<void(msg::rcl_interfaces_ParameterValue&)>& fill) {
    msg::rcl_interfaces_Parameter asked{};
    asked.name = runtime::lend(name);
    asked.value.type = type;
    static char none[] = "";
    asked.value.string_value = none;
    fill(asked.value);
    return change_of(all_, asked);
  }
  const scene::Scene scene_ =
      scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  const std::vector<effects::EffectSpec> effects_ = one_of_each_kind();
  const std::vector<RosParameter> all_ = parameters_of(scene_, effects_);
};

TEST_F(EffectParameters, CoverTheTableWithMeaningsAndRanges) {
  std::size_t count = 3;  // of the scene
  for (const effects::EffectSpec& effect : effects_) {
    count += effect.kind->parameters.size() + (effect.kind->everywhere ? 0 : 2);
    EXPECT_EQ(find_parameter(all_, effect.name + ".gain") != nullptr, !effect.kind->everywhere)
        << effect.name;
    for (std::size_t n = 0; n < effect.kind->parameters.size(); ++n) {
      const effects::EffectParameter& row = effect.kind->parameters[n];
      const RosParameter* const found =
          find_parameter(all_, effect.name + "." + std::string(row.name));
      ASSERT_NE(found, nullptr) << effect.name << row.name;
      EXPECT_EQ(found->meaning, row.meaning);
      EXPECT_EQ(found->read_only, row.shape == effects::ParameterShape::kWord ||
                                      row.shape == effects::ParameterShape::kText);
      if (row.shape == effects::ParameterShape::kNumber) {
        EXPECT_EQ(std::get<double>(found->value), effect.values.number(n)) << found->name;
        EXPECT_EQ(found->low, row.low);
        EXPECT_TRUE(std::isfinite(found->high) && found->high <= row.high) << found->name;
      } else {
        EXPECT_FALSE(found->constraints.empty()) << found->name;
      }
      ParameterMessages messages;
      EXPECT_EQ(messages.descriptor(*found).floating_point_range._length,
                row.shape == effects::ParameterShape::kNumber ? 1U : 0U)
          << found->name;
    }
  }
  EXPECT_EQ(all_.size(), count);
  EXPECT_TRUE(std::ranges::is_sorted(all_, {}, &RosParameter::name));
}

TEST_F(EffectParameters, AreListedByPrefixAndDepthAsRclcppDoes) {
  const std::vector<std::string> none, friction{"friction"}, exact{"friction.gain"},
      unknown{"frict"};
  EXPECT_EQ(list_parameters(all_, none, 0).names.size(), all_.size());
  EXPECT_EQ(list_parameters(all_, none, 1).names,
            (std::vector<std::string>{"contact_model", "scene", "voxel_size_m"}));
  EXPECT_EQ(list_parameters(all_, none, 2).names.size(), all_.size());
  EXPECT_EQ(list_parameters(all_, friction, 1).names, list_parameters(all_, friction, 0).names);
  EXPECT_EQ(list_parameters(all_, friction, 0).prefixes, friction);
  EXPECT_EQ(list_parameters(all_, exact, 1).names, exact);
  EXPECT_TRUE(list_parameters(all_, unknown, 0).names.empty());
}

TEST_F(EffectParameters, RequestTheChangeTheyName) {
  using namespace msg::effect_change;
  const auto on = set("friction.on", 1, [](auto& v) { v.bool_value = true; });
  ASSERT_TRUE(on);
  EXPECT_TRUE(on->action == kActionSwitch && on->effect == "friction" && on->parameter.empty() &&
              on->value[0] == 1.0);
  const auto gain = set("friction.gain", 2, [](auto& v) { v.integer_value = 1; });
  ASSERT_TRUE(gain);
  EXPECT_TRUE(gain->action == kActionGain && gain->value[0] == 1.0);
  double three[] = {1.0, 2.0, 3.0};
  const auto point = set("guide_point.point", 8, [&](auto& v) {
    v.double_array_value._buffer = three, v.double_array_value._length = 3;
  });
  ASSERT_TRUE(point);
  const msg::EffectChange m = point->message();
  EXPECT_TRUE(m.action == kActionValue && m.parameter == std::string("point") && m.value[2] == 3.0);
  EXPECT_TRUE(set("nothing.gain", 3, [](auto& v) { v.double_value = 0.5; }))
      << "who judges changes has the sentence for it";
}

TEST_F(EffectParameters, RefuseTypesThatTheyDoNotTake) {
  double four[] = {1.0, 2.0, 3.0, 4.0};
  const auto array = [&](std::uint32_t count) {
    return [&four, count](auto& v) {
      v.double_array_value._buffer = four, v.double_array_value._length = count;
    };
  };
  const auto nothing = [](auto&) {};
  EXPECT_FALSE(set("friction.on", 3, nothing));
  EXPECT_FALSE(set("friction.coulomb", 1, nothing));
  EXPECT_FALSE(set("friction.coulomb", 0, nothing)) << "a parameter cannot be deleted";
  EXPECT_FALSE(set("friction.coulomb", 8, array(3)));
  EXPECT_FALSE(set("guide_point.point", 3, nothing));
  EXPECT_FALSE(set("guide_point.point", 8, array(4)));
  EXPECT_FALSE(set("scene", 4, nothing));
  EXPECT_FALSE(set("unheard", 3, nothing));
  EXPECT_FALSE(set("", 255, nothing));
}

TEST(RequestsFit, WithinTheLongestMeaningfulTextsAndLists) {
  const std::string longest(1024, 'x'), longer(1025, 'x');
  EXPECT_TRUE(runtime::fits(longest.c_str()));
  EXPECT_FALSE(runtime::fits(longer.c_str()));
  EXPECT_FALSE(runtime::fits(nullptr));
  std::vector<double> numbers(17);
  msg::rcl_interfaces_Parameter parameter{};
  parameter.name = parameter.value.string_value = runtime::lend(longest);
  parameter.value.double_array_value._buffer = numbers.data();
  parameter.value.double_array_value._length = 16;
  EXPECT_TRUE(runtime::fits(parameter));
  parameter.value.double_array_value._length = 17;
  EXPECT_FALSE(runtime::fits(parameter));
  parameter.value.double_array_value._length = 0;
  std::vector<char*> texts{runtime::lend(longer)};
  parameter.value.string_array_value._buffer = texts.data();
  parameter.value.string_array_value._length = 1;
  EXPECT_FALSE(runtime::fits(parameter));
}

}  // namespace
}  // namespace voxtouch::rendering_node

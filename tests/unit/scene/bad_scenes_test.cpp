#include <algorithm>
#include <ctime>
#include <vector>

#include "core/mesh/import.hpp"
#include "core/rendering/build.hpp"
#include "tests/support/facts.hpp"
#include "tests/unit/mesh/samples.hpp"
#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::scene {
namespace {

using BadScene = SceneFolder;

/// One change to a good scene, and the facts that the error must name. A '^' in `to` marks the
/// place that the error must name; it is taken out before the text is read.
struct Bad {
  const char* from;  ///< in kFull; "" = `to` is the whole scene
  const char* to;
  const char* facts;  ///< of the sentence, as `missing_fact` has them
};

constexpr const char* kCoupling = "kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 0.5";

const std::vector<Bad> kBad = {
    // keys
    {"scene: full", "^scen: full", "'scen'|'scene file'|'scene'"},
    {"voxel_size:", "^voxel_size_m:", "'voxel_size'"},
    {"effects: []", "^gravity: 9.81", "'gravity'|'scene file'|scene, voxel_size,"},
    {"scene: full\n", "^", "'scene'|'scene file'"},
    {"",
     "# no contact\n^scene: x\nvoxel_size: 1\nstatic: [{mesh: a.obj}]\ndynamic: {mesh: b.obj}\n",
     "'contact'"},
    {"stiffness_n_per_m: 12.5", "^stiffness: 12.5", "'stiffness_n_per_m'"},
    {"{model: original, stiffness_n_per_m: 12.5}", "^{model: original}",
     "'stiffness_n_per_m'|'contact'"},
    {"effects: []", "^voxel_size: 3", "'voxel_size'|line 3"},
    {"scale: 0.01, shell", "scale: 0.01, ^scale: 1, shell", "'scale'"},
    {"  round-1:", "  ^slide:", "'slide'"},
    {"gain: 0.5", "^gane: 0.5", "'gain'"},
    {"clutch_button: 1", "^clutch: 1", "'clutch_button'"},
    {"- mesh: b.obj", "- ^scale: 1", "'mesh'|'static'"},
    {"shell: naive", "^origin: [0, 0, 0]", "'origin'|'dynamic'"},
    {"sphere: {centre", "^ball: {centre", "'ball'|'parts'|sphere, box, cylinder"},
    {"radius: 0.04", "^diameter: 0.04", "'diameter'|'sphere'"},
    {"  slide:", "  ^sl/ide:", "letters, digits"},
    {"scene: full", "^[1]: full", "plain word"},
    {"scene: full", "^: full", "colon"},
    // types
    {"scene: full", "^scene:", "'scene'|nothing"},
    {"scene: full", "scene: ^''", "'scene'"},
    // names: they become part of file and topic names, and are shown
    {"scene: full", "scene: ^../../etc/x", "'scene'|'../../etc/x'|'.'"},
    {"scene: full", "scene: ^a/b", "'a/b'|letters, digits"},
    {"scene: full", "scene: ^\"a\\x1b[2Jb\"", "letters, digits"},
    {"scene: full", "scene: ^\"a\\nb\"", "letters, digits"},
    {"scene: full", "scene: ^Größe", "letters, digits"},
    {"scene: full", "scene: ^two words", "letters, digits"},
    {"scene: full", "scene: ^.hidden", "begins with a '.'."},
    {"scene: full", "scene: ^aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
     "64 characters"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, name: ^a/b}]", "'name'"},
    {"- mesh: b.obj", "- {mesh: b.obj, object: {name: ^\"o\\e[2J\"}}", "'name'"},
    {"2.0e-3", "^two", "'voxel_size'|'two'"},
    {"2.0e-3", "^'0.002'", "'0.002'|a number"},
    {"2.0e-3", "^aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaä123456789",
     "'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...'"},
    {"2.0e-3", "^0,002", "a number"},
    {"2.0e-3", "^0x10", "a number"},
    {"2.0e-3", "^1_000", "a number"},
    {"2.0e-3", "^2 mm", "a number"},
    {"2.0e-3", "^[0.002]", "number|list of 1"},
    {"position: [1, 2, 3]", "position: ^[1, 2]", "'position'|[x, y, z]|list of 3"},
    {"position: [1, 2, 3]", "position: [1, 2, ^{}]", "number|a map"},
    {"position: [1, 2, 3]", "position: ^1", "3 numbers"},
    {"[0.7071068, 0.7071068, 0, 0]", "^[1, 0, 0]", "[w, x, y, z]"},
    {"clutch_button: 1", "clutch_button: ^-1", "whole number"},
    {"clutch_button: 1", "clutch_button: ^1.5", "whole number"},
    {"contact: {model: original, stiffness_n_per_m: 12.5}", "contact: ^adapted",
     "'contact'|model,"},
    {"effects: []", "effects: ^none", "'effects'|'none'"},
    {"circle: {centre: [0, 0, 0], axis: [0, 0, 2]}", "circle: ^1", "'circle'|centre, axis"},
    {"parts: [{sphere: {radius: 1}}]", "parts: ^{sphere: {radius: 1}}", "'parts'|a map"},
    {"",
     "scene: x\nvoxel_size: 1\nstatic: [{mesh: a.obj}]\ndynamic: {mesh: b.obj}\ncontact: "
     "{stiffness_n_per_m: 1}\nmotions: ^[1]\n",
     "'motions'"},
    // numbers
    {"2.0e-3", "^.nan", "finite"},
    {"2.0e-3", "^-.Inf", "finite"},
    {"2.0e-3", "^infinity", "finite"},
    {"2.0e-3", "^nan", "finite"},
    {"2.0e-3", "^1e999", "finite"},
    {"2.0e-3", "^0", "'voxel_size'|above 0"},
    {"2.0e-3", "^-0.002", "'voxel_size'|above 0"},
    {"[1, 2, 3]", "[1, ^.nan, 3]", "finite"},
    {"scale: 0.5", "scale: ^0", "'scale'|above 0"},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m: ^-1", "above 0"},
    {"[0.7071068, 0.7071068, 0, 0]", "^[0.5, 0, 0, 0]", "norm 0.5|within 0.001 of 1"},
    {"[0, 0, 0, -1]", "^[0, 0, 0, 0]", "norm 0;"},
    {"size: [1, 2, 3]", "size: ^[1, 0, 3]", "'size'|above 0"},
    {"length: 2", "length: ^-2", "'length' is -2"},
    {"force_scale: 0.25", "force_scale: ^0", "'force_scale' is 0"},
    {"clutch_button: 1", "clutch_button: ^32", "0 to 31"},
    {"hold_s: 0.25", "hold_s: ^-1", "'hold_s'|0 or above"},
    {"speed_m_per_s: 0.1,", "speed_m_per_s: ^0,", "'speed_m_per_s' is 0"},
    {"repeat_from: 1", "repeat_from: ^2", "'repeat_from'|below 2"},
    {"repeat_from: 1", "repeat_from: ^18446744073709551615", "below 2"},
    // meaning
    {"mesh: a.obj", "mesh: ^nothere.obj", "'nothere.obj'"},
    {"mesh: a.obj", "mesh: ^.", "'.'"},
    {"  - mesh: b.obj", "  - {mesh: b.obj, ^origin: [0, 0, 0]}", "'origin'"},
    {"shell: naive", "shell: ^rough", "'shell'|'rough'|exact, naive"},
    {"model: original", "model: ^adpated", "'adapted'"},
    {"model: original, stiffness_n_per_m: 12.5", "model: field, ^stiffness_n_per_m: 12.5",
     "'stiffness_n_per_m'|'field'|stiffness_n_per_m3"},
    {"model: original, stiffness_n_per_m: 12.5", "model: ^clustered, stiffness_n_per_m3: 1e6",
     "'clustered'|'model: field'|stiffness_n_per_m3|'model: adapted'"},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m: 12.5, ^stiffness_n_per_m3: 1e6", "exclude"},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m3: ^0", "'stiffness_n_per_m3'"},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: virtual_tool, ^model: adapted",
     "'rendering: virtual_tool'|model: field"},
    {"model: original, stiffness_n_per_m: 12.5",
     "rendering: virtual_tool, ^stiffness_n_per_m3: 1e6",
     "'stiffness_n_per_m3'|'rendering: virtual_tool'"},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: virtual_tool, ^stiffness_n_per_m: 30",
     "'stiffness_n_per_m'|'rendering: virtual_tool'"},
    {"model: original, stiffness_n_per_m: 12.5", "^rendering: virtual_tool",
     "{design: auto}|stiffness_cap_n_per_m"},
    {"model: original, stiffness_n_per_m: 12.5", "^model: field",
     "'rendering: virtual_tool'|{design: auto}|stiffness_cap_n_per_m"},
    {"{model: original, stiffness_n_per_m: 12.5", "^{model: field, rendering: penalty",
     "'stiffness_n_per_m3'"},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: ^tool",
     "'rendering'|virtual_tool, penalty"},
    {"effects: []", "tool: {lever_m: ^0}", "'lever_m'|above 0"},
    {"effects: []", "tool: {^lever: 1}", "'lever_m'"},
    {"effects: []", "effects: [{^stickiness: {coulomb: 0.3}}]", "'stickiness'|'an effect'"},
    {"effects: []", "effects: [{^viscocity: {}}]", "'viscosity'"},
    {"effects: []", "effects: [^viscosity]", "a map"},
    {"effects: []", "effects: [^{gain: 1}]", "no effect"},
    {"effects: []", "effects: [{viscosity: ^{}}]", "'damping_ns_per_m'|'viscosity'"},
    {"effects: []", "effects: [{viscosity: {^damping: 1}}]", "'damping_ns_per_m'"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^-1}}]",
     "'damping_ns_per_m'|0 to 100."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^1000}}]", "0 to 100.|a number"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^.inf}}]", "'damping_ns_per_m'"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, gain: ^1.5}]", "'gain'|0 to 1."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, region: ^{blend_m: 1}}]",
     "'region'|sphere, box"},
    {"effects: []",
     "effects: [{viscosity: {damping_ns_per_m: 1}}, ^{viscosity: {damping_ns_per_m: 2}}]",
     "'viscosity'"},
    {"kind: shaping_filter", "kind: ^shaping", "'shaping_filter'"},
    {"kind: shaping_filter, cutoff_hz", "kind: direct, ^cutoff_hz",
     "'cutoff_hz'|kind: shaping_filter"},
    {"gain: 0.5", "^damping_ns_per_m: 1", "kind: spring_damper"},
    // coupling: by hand
    {"gain: 0.5", "^hand: pen", "'hand'|'design: auto'"},
    {"gain: 0.5", "^gain_margin: 2", "'gain_margin'|'design: auto'"},
    {"gain: 0.5", "^released: true", "'released'|'design: auto'"},
    {"gain: 0.5", "^inject_damping: true", "'inject_damping'|'design: auto'"},
    {"gain: 0.5", "^velocity_windows: true", "'velocity_windows'|'design: auto'"},
    {"gain: 0.5", "^run_infeasible: true", "'run_infeasible'|'design: auto'"},
    {"kind: shaping_filter", "kind: ^auto", "'kind: auto'|'design: auto'"},
    {"gain: 0.5", "stiffness_cap_n_per_m: ^0", "'stiffness_cap_n_per_m'|above 0"},
    {"gain: 0.5", "stiffness_cap_nm_per_rad: ^.inf", "'stiffness_cap_nm_per_rad'|finite"},
    {"gain: 0.5", "^stiffness_cap: 10", "'stiffness_cap_n_per_m'"},
    {"gain: 0.5", "injected_damping_ns_per_m: ^-1", "'injected_damping_ns_per_m'|0 or above"},
    {"gain: 0.5", "injected_damping_nms_per_rad: ^-1", "0 or above"},
    {"gain: 0.5", "^velocity_filter_hz: 50", "injected_damping_ns_per_m"},
    {"gain: 0.5", "injected_damping_ns_per_m: 1, velocity_filter_hz: ^0",
     "'velocity_filter_hz' is 0"},
    {"gain: 0.5", "^slow_velocity_hz: 10", "requires injected_damping_ns_per_m or"},
    {"gain: 0.5", "^velocity_band_m_per_s: 0.01", "requires injected_damping_ns_per_m or"},
    {"gain: 0.5", "injected_damping_ns_per_m: 1, slow_velocity_hz: ^-1", "0 or above"},
    {"gain: 0.5", "^velocity_window: 2", "requires injected_damping_ns_per_m or"},
    {"gain: 0.5", "injected_damping_ns_per_m: 1, velocity_window: ^6",
     "velocity_window is 6; it must be an integer from 0 to 5."},
    // coupling: designed
    {kCoupling, "design: ^yes", "'design'|'yes'|auto"},
    {kCoupling, "design: ^true", "'design'|auto"},
    {kCoupling, "^design:", "'design'|auto,"},
    {kCoupling, "design: ^Auto", "'auto'"},
    {kCoupling, "design: auto, ^gain: 0.5", "'gain'"},
    {kCoupling, "design: auto, ^damping_ratio: 1", "'damping_ratio'"},
    {kCoupling, "design: auto, ^stiffness_n_per_m: 1", "'stiffness_n_per_m'"},
    {kCoupling, "design: auto, ^damping_ns_per_m: 1", "'damping_ns_per_m'"},
    {kCoupling, "design: auto, ^injected_damping_ns_per_m: 1", "designer"},
    {kCoupling, "design: auto, ^injected_damping_nms_per_rad: 1", "designer"},
    {kCoupling, "design: auto, ^velocity_filter_hz: 50", "designer"},
    {kCoupling, "design: auto, ^velocity_window: 2", "designer"},
    {kCoupling, "design: auto, kind: ^shaping", "'shaping_filter'"},
    {kCoupling, "design: auto, kind: direct, ^cutoff_hz: 5",
     "'cutoff_hz'|kind: auto or shaping_filter"},
    {kCoupling, "design: auto, cutoff_hz: ^-5", "'cutoff_hz' is -5"},
    {kCoupling, "design: auto, cutoff_hz: ^500", "limit pi"},
    {kCoupling, "design: auto, gain_margin: ^0.5", "'gain_margin'|1 or above"},
    {kCoupling, "design: auto, stiffness_cap_n_per_m: ^-1", "above 0"},
    {kCoupling, "design: auto, stiffness_cap_nm_per_rad: ^0", "above 0"},
    {kCoupling, "design: auto, hand: ^pencil", "'hand'|'pencil'|pen, arm, any_passive"},
    {kCoupling, "design: auto, hand: ^[0, 1]", "list of 2"},
    {kCoupling, "design: auto, hand: ^{mass_kg: [0, 1]}", "'damping_ns_per_m'|'hand'"},
    {kCoupling, "design: auto, hand: {^mass: [0, 1]}", "'mass_kg'"},
    {kCoupling,
     "design: auto, hand: {mass_kg: ^[2, 1], damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1]}",
     "'mass_kg'|[2, 1]"},
    {kCoupling,
     "design: auto, hand: {mass_kg: ^1, damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1]}",
     "'mass_kg'|[low, high]"},
    {kCoupling,
     "design: auto, hand: {mass_kg: [0, 1], damping_ns_per_m: [^-1, 1], stiffness_n_per_m: [0, 1]}",
     "must be 0 or above"},
    {kCoupling,
     "design: auto, hand: ^{mass_kg: [0, 1], damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1], "
     "inertia_kg_m2: [0, 1]}",
     "'damping_nms_per_rad'|'hand'"},
    {kCoupling, "design: auto, released: ^no", "'released'|'no'|true or false"},
    {kCoupling, "design: auto, inject_damping: ^1", "'inject_damping'|true or false"},
    {kCoupling, "design: auto, run_infeasible: ^'true'", "'run_infeasible'|true or false"},
    {kCoupling, "design: auto, hand: any_passive, ^released: false",
     "'released: false'|'hand: any_passive'"},
    {"cutoff_hz: 5", "cutoff_hz: ^500", "3.14|0.001 s|limit pi"},
    {"damping_ratio: 1", "damping_ratio: ^0", "'damping_ratio'|above 0"},
    {"gain: 0.5", "gain: ^0", "'gain'|above 0"},
    {"axis: [0, 0, 2]", "^axis: [0, 0, 0]", "'axis'"},
    {"centre: [0, 0, 0], axis", "^centre: [0.1, 0, 5], axis", "radius"},
    {"path: [[0.1, 0, 0]], circle", "path: ^[], circle", "'path'"},
    {"path: [[0.1, 0, 0]], circle", "path: [[0.1, 0, 0], [0, 1, 0]], repeat_from: 0, ^circle",
     "'circle'|'repeat_from'"},
    {"{sphere: {radius: 1}}", "^{sphere: {radius: 1}, box: {size: [1, 1, 1]}}", "one of"},
    // whole files
    {"", "^", "empty"},
    {"", "^# only a comment\n", "empty"},
    {"", "^just words", "'scene file'|scene,"},
    {"", "^- a\n- b\n", "'scene file'"},
    {"", "scene: a\n^scene: b\n", "'scene'|line 1"},
    {"", "scene: [a\nvoxel_size^: 1\n", "YAML"},
    {"", "scene: 'a^\n", "YAML"},
    {"", "\tscene^: a\n", "YAML"},
    {"", "scene: a\n---\n^scene: b\n", "document"},
    {"", "scene: ^!!str a\n", "Tags"},
    {"", "scene: ^&a b\n", "Anchors"},
    {"",
     "sc^\xff"
     "ene: a\n",
     "byte 0xff"},
    {"", "scene: a\nvo^\x01xel: 1\n", "byte 0x01"},
    {"",
     "static: ^[]\nscene: a\nvoxel_size: 1\ndynamic: {mesh: a.obj}\ncontact: {stiffness_n_per_m: "
     "1}\n",
     "'static'"},
};

SourcePlace place_at(const std::string& text, std::size_t at) {
  SourcePlace place{1, 1};
  for (std::size_t i = 0; i < at; ++i) {
    ++place.column;
    if (text[i] == '\n')
      ++place.line, place.column = 1;
  }
  return place;
}

TEST_F(BadScene, IsReportedWithItsPlace) {
  for (const Bad& bad : kBad) {
    std::string text = bad.to;
    if (*bad.from != '\0') {
      text = kFull;
      const std::size_t at = text.find(bad.from);
      ASSERT_NE(at, std::string::npos) << bad.from;
      text.replace(at, std::string(bad.from).size(), bad.to);
    }
    const std::size_t mark = text.find('^');
    ASSERT_NE(mark, std::string::npos) << bad.to;
    text.erase(mark, 1);
    const SourcePlace place = place_at(text, mark);
    try {
      parse(text);
      ADD_FAILURE() << "was accepted: " << bad.to;
    } catch (const SceneError& error) {
      const std::string head = at_place(folder_ / "s.yaml", place, "");
      EXPECT_TRUE(std::string(error.what()).starts_with(head))
          << bad.to << "\n  wanted " << head << "\n  got    " << error.what();
      EXPECT_EQ(test::missing_fact(error.sentence(), bad.facts), "")
          << bad.to << "\n  " << error.what();
      EXPECT_TRUE(error.sentence().ends_with('.') || error.sentence().ends_with('?'))
          << error.what();
      EXPECT_TRUE(error.place().line == place.line && error.place().column == place.column);
    }
  }
  EXPECT_GE(kBad.size(), 90U);
}

TEST_F(BadScene, InvalidFiles) {
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      load_scene(file);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_TRUE(refusal(folder_ / "no.yaml").starts_with((folder_ / "no.yaml").string() + ": "));
  EXPECT_NE(refusal(folder_).find("folder"), std::string::npos);
  EXPECT_NE(refusal("/dev/null").find("regular file"), std::string::npos);
  EXPECT_NE(refusal(""), "accepted");
  EXPECT_NE(
      refusal(write("big.yaml", std::string((1 << 20) + 1, '#'))).find("larger than 1048576 bytes"),
      std::string::npos);
  EXPECT_NE(refusal(write("edge.yaml", std::string(1 << 20, '#'))).find("empty"),
            std::string::npos);
  EXPECT_NE(refusal(write("empty.yaml", "")).find("empty"), std::string::npos);
  EXPECT_NE(refusal(write("nul.yaml", std::string(100, '\0'))).find(":1:1: Invalid byte 0x00"),
            std::string::npos);
  std::string elf =
      "\x7f"
      "ELF\x02\x01\x01";
  EXPECT_NE(refusal(write("elf.yaml", elf)).find("byte 0x"), std::string::npos);
}

/// Small files that expand to huge or endless ones are refused early.
TEST_F(BadScene, YamlBombsAreRefused) {
  std::string bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n";
  for (char c = 'b'; c < 'j'; ++c) {
    bomb.append(1, c).append(": &").append(1, c).append(" [");
    for (int k = 0; k < 9; ++k)
      bomb.append(k ? ",*" : "*").append(1, static_cast<char>(c - 1));
    bomb.append("]\n");
  }
  EXPECT_THROW(parse(bomb), SceneError);
  for (const int depth : {40, 1000, 10'000, 500'000}) {
    EXPECT_THROW(parse(std::string(static_cast<std::size_t>(depth), '[')), SceneError) << depth;
    EXPECT_THROW(parse("scene: " + std::string(static_cast<std::size_t>(depth), '{')), SceneError)
        << depth;
  }
  try {
    parse("effects: " + std::string(40, '[') + std::string(40, ']'));
    ADD_FAILURE() << "forty levels were accepted";
  } catch (const SceneError& error) {
    EXPECT_NE(error.sentence().find("32 levels"), std::string::npos) << error.sentence();
    EXPECT_EQ(error.place().column, 41);
  }
  std::string deep;
  for (int k = 0; k < 500; ++k)
    deep.append(static_cast<std::size_t>(k), ' ').append("a:\n");
  EXPECT_THROW(parse(deep), SceneError);
  std::string dashes;
  for (int k = 0; k < 3000; ++k)
    dashes += "- ";
  EXPECT_THROW(parse(dashes), SceneError);
  EXPECT_THROW(parse(std::string(300'000, '-')), SceneError);
  std::string many = "effects: [";
  for (int k = 0; k < 300'000; ++k)
    many += "1,";
  EXPECT_THROW(parse(many + "]"), SceneError);
  std::string keys;
  for (int k = 0; k < 20'000; ++k)
    keys.append("k").append(std::to_string(k)).append(": 1\n");
  EXPECT_THROW(parse(keys), SceneError);
}

TEST_F(BadScene, NamesOfEveryPlainKindAreTaken) {
  for (const std::string& name :
       std::vector<std::string>{"cup", "Cup-2.1_b", "7", "a.", "-", std::string(64, 'a')}) {
    std::string text = kSmall;
    text.replace(text.find("small"), 5, "'" + name + "'");
    EXPECT_EQ(parse(text).name, name);
  }
}

/// Its size is checked before it is read: these two gigabytes are not on the disk, and reading them
/// takes a minute.
TEST_F(BadScene, AMeshOfGigabytesIsRefusedBeforeItIsRead) {
  std::ofstream(folder_ / "huge.obj") << "v 0 0 0\n";
  std::filesystem::resize_file(folder_ / "huge.obj", std::uintmax_t{2} << 30);
  for (const char* mesh : {"a.obj", "b.obj"}) {
    std::string text = kSmall;
    text.replace(text.find(mesh), 5, "huge.obj");
    const auto begin = std::clock();
    try {
      parse(text);
      ADD_FAILURE() << "was taken";
    } catch (const SceneError& error) {
      EXPECT_NE(error.sentence().find("2147483648 bytes"), std::string::npos) << error.what();
      EXPECT_GT(error.place().line, 1);
    }
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC,
              0.5);  // CPU time of this process
  }
}

/// The bytes used for the build are those of the scene's hash.
TEST_F(BadScene, MeshChangedBeforeBuildingIsRejected) {
  const Scene scene = parse(kSmall);
  EXPECT_EQ(scene.mesh_hashes.size(), 2U);
  write("b.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n");
  try {
    rendering::build_scene(scene, serial_for());
    ADD_FAILURE() << "was built";
  } catch (const mesh::MeshError& error) {
    EXPECT_NE(std::string(error.what()).find("b.obj': "), std::string::npos) << error.what();
  }
}

/// Only its JSON is in the .gltf.
TEST_F(BadScene, MeshWithAChangedBufferFileIsRejected) {
  samples::Gltf gltf;
  gltf.buffer = R"({"byteLength":72,"uri":"b.bin"})";
  write("b.gltf", gltf.json());
  std::string buffer = samples::gltf_buffer();
  write("b.bin", buffer);
  std::string text = kSmall;
  text.replace(text.find("b.obj"), 5, "b.gltf, scale: 0.01");
  const Scene scene = parse(text);
  EXPECT_EQ(parse(text).hash, scene.hash);
  EXPECT_NO_THROW(rendering::build_scene(scene, serial_for()));
  buffer[14] ^= 0x40;  // another coordinate
  write("b.bin", buffer);
  EXPECT_NE(parse(text).hash, scene.hash);
  try {
    rendering::build_scene(scene, serial_for());
    ADD_FAILURE() << "was built";
  } catch (const mesh::MeshError& error) {
    EXPECT_NE(std::string(error.what()).find("b.gltf': "), std::string::npos) << error.what();
  }
}

TEST_F(BadScene, UnreadableMeshesAreNamed) {
  std::filesystem::create_directory(folder_ / "dir.obj");
  EXPECT_THROW(parse("scene: x\nvoxel_size: 1\nstatic: [{mesh: dir.obj}]\ndynamic: {mesh: "
                     "b.obj}\ncontact: {stiffness_n_per_m: 1}\n"),
               SceneError);
}

TEST_F(BadScene, AMeshIsRefusedWithTheVerbThatWritesAScene) {
  for (const char* name : {"part.stl", "PART.OBJ", "a.b.glb"}) {
    try {
      parse_scene("\x9c\0solid", folder_ / name);
      ADD_FAILURE() << name << " was read";
    } catch (const SceneError& error) {
      EXPECT_EQ(test::missing_fact(error.what(), "voxtouch new"), "") << error.what();
    }
  }
}

}  // namespace
}  // namespace voxtouch::scene

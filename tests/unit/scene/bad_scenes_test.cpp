#include <algorithm>
#include <ctime>
#include <vector>

#include "core/mesh/import.hpp"
#include "core/rendering/build.hpp"
#include "tests/unit/mesh/samples.hpp"
#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::scene {
namespace {

using BadScene = SceneFolder;

/// One change to a good scene, and the words of the error that it must bring. A '^' in `to` marks the place that the error
/// must name; it is taken out before the text is read.
struct Bad {
  const char* from;  ///< in kFull; "" = `to` is the whole scene
  const char* to;
  const char* says;
};

constexpr const char* kCoupling = "kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 0.5";

const std::vector<Bad> kBad = {
    // keys
    {"scene: full", "^scen: full", "'scen' is no key of 'scene file'; did you mean 'scene'?"},
    {"voxel_size:", "^voxel_size_m:", "did you mean 'voxel_size'?"},
    {"effects: []", "^gravity: 9.81", "'gravity' is no key of 'scene file'. Allowed: scene, voxel_size,"},
    {"scene: full\n", "^", "'scene' is missing in 'scene file'."},
    {"", "# no contact\n^scene: x\nvoxel_size: 1\nstatic: [{mesh: a.obj}]\ndynamic: {mesh: b.obj}\n", "'contact' is missing"},
    {"stiffness_n_per_m: 12.5", "^stiffness: 12.5", "did you mean 'stiffness_n_per_m'?"},
    {"{model: original, stiffness_n_per_m: 12.5}", "^{model: original}", "'stiffness_n_per_m' is missing in 'contact'."},
    {"effects: []", "^voxel_size: 3", "The key 'voxel_size' is here twice; the first is in line 3."},
    {"scale: 0.01, shell", "scale: 0.01, ^scale: 1, shell", "'scale' is here twice"},
    {"  round-1:", "  ^slide:", "'slide' is here twice"},
    {"gain: 0.5", "^gane: 0.5", "did you mean 'gain'?"},
    {"clutch_button: 1", "^clutch: 1", "did you mean 'clutch_button'?"},
    {"- mesh: b.obj", "- ^scale: 1", "'mesh' is missing in 'static'."},
    {"shell: naive", "^origin: [0, 0, 0]", "'origin' is no key of 'dynamic'"},
    {"sphere: {centre", "^ball: {centre", "'ball' is no key of 'parts'. Allowed: sphere, box, cylinder."},
    {"radius: 0.04", "^diameter: 0.04", "'diameter' is no key of 'sphere'"},
    {"  slide:", "  ^sl/ide:", "holds other than letters, digits, '_', '-' and '.'"},
    {"scene: full", "^[1]: full", "A key must be a plain word"},
    {"scene: full", "^: full", "A key is missing before the colon"},
    // types
    {"scene: full", "^scene:", "'scene' must be a text, but here is nothing"},
    {"scene: full", "scene: ^''", "'scene' is empty"},
    // names: they become part of file and topic names, and are shown
    {"scene: full", "scene: ^../../etc/x", "'scene' is a name, and the word '../../etc/x' begins with a '.'."},
    {"scene: full", "scene: ^a/b", "the word 'a/b' holds other than letters, digits, '_', '-' and '.'."},
    {"scene: full", "scene: ^\"a\\x1b[2Jb\"", "holds other than letters, digits, '_', '-' and '.'."},
    {"scene: full", "scene: ^\"a\\nb\"", "holds other than letters, digits"},
    {"scene: full", "scene: ^Größe", "holds other than letters, digits"},
    {"scene: full", "scene: ^two words", "holds other than letters, digits"},
    {"scene: full", "scene: ^.hidden", "begins with a '.'."},
    {"scene: full", "scene: ^aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "is longer than 64 characters."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, name: ^a/b}]", "'name' is a name, and"},
    {"- mesh: b.obj", "- {mesh: b.obj, object: {name: ^\"o\\e[2J\"}}", "'name' is a name, and"},
    {"2.0e-3", "^two", "'voxel_size' must be a number, but here is the word 'two'"},
    {"2.0e-3", "^'0.002'", "must be a number, but here is the text '0.002'"},
    {"2.0e-3", "^aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaä123456789", "the word 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...'."},
    {"2.0e-3", "^0,002", "must be a number"},
    {"2.0e-3", "^0x10", "must be a number"},
    {"2.0e-3", "^1_000", "must be a number"},
    {"2.0e-3", "^2 mm", "must be a number"},
    {"2.0e-3", "^[0.002]", "must be a number, but here is a list of 1"},
    {"position: [1, 2, 3]", "position: ^[1, 2]", "'position' must be a list of 3 numbers [x, y, z], but here is a list of 2"},
    {"position: [1, 2, 3]", "position: [1, 2, ^{}]", "must be a number, but here is a map"},
    {"position: [1, 2, 3]", "position: ^1", "must be a list of 3 numbers"},
    {"[0.7071068, 0.7071068, 0, 0]", "^[1, 0, 0]", "must be a unit quaternion [w, x, y, z]"},
    {"clutch_button: 1", "clutch_button: ^-1", "must be a whole number from 0"},
    {"clutch_button: 1", "clutch_button: ^1.5", "must be a whole number from 0"},
    {"contact: {model: original, stiffness_n_per_m: 12.5}", "contact: ^adapted", "'contact' must be a map with the keys: model,"},
    {"effects: []", "effects: ^none", "'effects' must be a list, but here is the word 'none'"},
    {"circle: {centre: [0, 0, 0], axis: [0, 0, 2]}", "circle: ^1", "'circle' must be a map with the keys: centre, axis"},
    {"parts: [{sphere: {radius: 1}}]", "parts: ^{sphere: {radius: 1}}", "'parts' must be a list, but here is a map"},
    {"", "scene: x\nvoxel_size: 1\nstatic: [{mesh: a.obj}]\ndynamic: {mesh: b.obj}\ncontact: {stiffness_n_per_m: 1}\nmotions: ^[1]\n", "'motions' must be a map of names to motions"},
    // numbers
    {"2.0e-3", "^.nan", "must be a finite number"},
    {"2.0e-3", "^-.Inf", "must be a finite number"},
    {"2.0e-3", "^infinity", "must be a finite number"},
    {"2.0e-3", "^nan", "must be a finite number"},
    {"2.0e-3", "^1e999", "must be a finite number within the range of a double"},
    {"2.0e-3", "^0", "'voxel_size' is 0; it must be above 0."},
    {"2.0e-3", "^-0.002", "'voxel_size' is -0.002; it must be above 0."},
    {"[1, 2, 3]", "[1, ^.nan, 3]", "must be a finite number"},
    {"scale: 0.5", "scale: ^0", "'scale' is 0; it must be above 0."},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m: ^-1", "must be above 0"},
    {"[0.7071068, 0.7071068, 0, 0]", "^[0.5, 0, 0, 0]", "a quaternion of norm 0.5; it must be within 0.001 of 1"},
    {"[0, 0, 0, -1]", "^[0, 0, 0, 0]", "a quaternion of norm 0;"},
    {"size: [1, 2, 3]", "size: ^[1, 0, 3]", "'size' must be above 0 along each axis"},
    {"length: 2", "length: ^-2", "'length' is -2"},
    {"force_scale: 0.25", "force_scale: ^0", "'force_scale' is 0"},
    {"clutch_button: 1", "clutch_button: ^32", "buttons count from 0 to 31"},
    {"hold_s: 0.25", "hold_s: ^-1", "'hold_s' is -1; it must be 0 or above."},
    {"speed_m_per_s: 0.1,", "speed_m_per_s: ^0,", "'speed_m_per_s' is 0"},
    {"repeat_from: 1", "repeat_from: ^2", "'repeat_from' is 2; it must be below 2, the last point"},
    {"repeat_from: 1", "repeat_from: ^18446744073709551615", "it must be below 2"},
    // meaning
    {"mesh: a.obj", "mesh: ^nothere.obj", "There is no mesh file 'nothere.obj'"},
    {"mesh: a.obj", "mesh: ^.", "There is no mesh file '.'"},
    {"  - mesh: b.obj", "  - {mesh: b.obj, ^origin: [0, 0, 0]}", "'origin' is given twice"},
    {"shell: naive", "shell: ^rough", "'shell' must be one of: exact, naive; here is the word 'rough'."},
    {"model: original", "model: ^adpated", "did you mean 'adapted'?"},
    {"model: original, stiffness_n_per_m: 12.5", "model: field, ^stiffness_n_per_m: 12.5",
     "'stiffness_n_per_m' is per shell point; 'field' weighs points by their area and takes stiffness_n_per_m3."},
    {"model: original, stiffness_n_per_m: 12.5", "model: ^clustered, stiffness_n_per_m3: 1e6",
     "The contact model 'clustered' is gone. Write 'model: field' with the same stiffness_n_per_m3; where a static mesh is not closed, "
     "'model: adapted' with it."},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m: 12.5, ^stiffness_n_per_m3: 1e6", "exclude each other; give one of them."},
    {"stiffness_n_per_m: 12.5", "stiffness_n_per_m3: ^0", "'stiffness_n_per_m3'"},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: virtual_tool, ^model: adapted", "'rendering: virtual_tool' goes with model: field, not with adapted."},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: virtual_tool, ^stiffness_n_per_m3: 1e6", "'stiffness_n_per_m3' does not go with 'rendering: virtual_tool': the coupling's certified stiffness is felt."},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: virtual_tool, ^stiffness_n_per_m: 30", "'stiffness_n_per_m' does not go with 'rendering: virtual_tool'"},
    {"model: original, stiffness_n_per_m: 12.5", "^rendering: virtual_tool", "the coupling names none: give coupling: {design: auto}, or its stiffness_cap_n_per_m."},
    {"model: original, stiffness_n_per_m: 12.5", "rendering: ^tool", "'rendering' must be one of: virtual_tool, penalty"},
    {"effects: []", "tool: {lever_m: ^0}", "'lever_m' is 0; it must be above 0."},
    {"effects: []", "tool: {^lever: 1}", "did you mean 'lever_m'?"},
    {"effects: []", "effects: [{^stickiness: {coulomb: 0.3}}]", "'stickiness' is no key of 'an effect'"},
    {"effects: []", "effects: [{^viscocity: {}}]", "did you mean 'viscosity'?"},
    {"effects: []", "effects: [^viscosity]", "An effect is a map such as"},
    {"effects: []", "effects: [^{gain: 1}]", "The entry names no effect; there are:"},
    {"effects: []", "effects: [{viscosity: ^{}}]", "'damping_ns_per_m' is missing in 'viscosity'."},
    {"effects: []", "effects: [{viscosity: {^damping: 1}}]", "did you mean 'damping_ns_per_m'?"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^-1}}]", "'damping_ns_per_m' must be a number from 0 to 100."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^1000}}]", "must be a number from 0 to 100."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: ^.inf}}]", "'damping_ns_per_m'"},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, gain: ^1.5}]", "'gain' is 1.5; it goes from 0 to 1."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}, region: ^{blend_m: 1}}]", "'region' needs one of: sphere, box."},
    {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 1}}, ^{viscosity: {damping_ns_per_m: 2}}]",
     "There is an effect named 'viscosity' already; give this one a name of its own"},
    {"kind: shaping_filter", "kind: ^shaping", "did you mean 'shaping_filter'?"},
    {"kind: shaping_filter, cutoff_hz", "kind: direct, ^cutoff_hz", "'cutoff_hz' goes with kind: shaping_filter, not with direct."},
    {"gain: 0.5", "^damping_ns_per_m: 1", "goes with kind: spring_damper, not with shaping_filter"},
    // coupling: by hand
    {"gain: 0.5", "^hand: pen", "'hand' goes with 'design: auto'."},
    {"gain: 0.5", "^gain_margin: 2", "'gain_margin' goes with 'design: auto'."},
    {"gain: 0.5", "^released: true", "'released' goes with 'design: auto'."},
    {"gain: 0.5", "^inject_damping: true", "'inject_damping' goes with 'design: auto'."},
    {"gain: 0.5", "^velocity_windows: true", "'velocity_windows' goes with 'design: auto'."},
    {"gain: 0.5", "^run_infeasible: true", "'run_infeasible' goes with 'design: auto'."},
    {"kind: shaping_filter", "kind: ^auto", "'kind: auto' goes with 'design: auto', which is not here."},
    {"gain: 0.5", "stiffness_cap_n_per_m: ^0", "'stiffness_cap_n_per_m' is 0; it must be above 0."},
    {"gain: 0.5", "stiffness_cap_nm_per_rad: ^.inf", "'stiffness_cap_nm_per_rad' must be a finite number"},
    {"gain: 0.5", "^stiffness_cap: 10", "did you mean 'stiffness_cap_n_per_m'?"},
    {"gain: 0.5", "injected_damping_ns_per_m: ^-1", "'injected_damping_ns_per_m' is -1; it must be 0 or above."},
    {"gain: 0.5", "injected_damping_nms_per_rad: ^-1", "it must be 0 or above."},
    {"gain: 0.5", "^velocity_filter_hz: 50", "goes with injected_damping_ns_per_m or"},
    {"gain: 0.5", "injected_damping_ns_per_m: 1, velocity_filter_hz: ^0", "'velocity_filter_hz' is 0"},
    {"gain: 0.5", "^velocity_window: 2", "goes with injected_damping_ns_per_m or"},
    {"gain: 0.5", "injected_damping_ns_per_m: 1, velocity_window: ^6", "velocity_window is 6; it must be a whole number from 0 to 5."},
    // coupling: designed
    {kCoupling, "design: ^yes", "'design' must be one of: auto; here is the word 'yes'."},
    {kCoupling, "design: ^true", "'design' must be one of: auto"},
    {kCoupling, "^design:", "'design' must be one of: auto, but here is nothing"},
    {kCoupling, "design: ^Auto", "did you mean 'auto'?"},
    {kCoupling, "design: auto, ^gain: 0.5", "'gain' is what the designer chooses; leave it out"},
    {kCoupling, "design: auto, ^damping_ratio: 1", "'damping_ratio' is what the designer chooses"},
    {kCoupling, "design: auto, ^stiffness_n_per_m: 1", "'stiffness_n_per_m' is what"},
    {kCoupling, "design: auto, ^damping_ns_per_m: 1", "'damping_ns_per_m' is what"},
    {kCoupling, "design: auto, ^injected_damping_ns_per_m: 1", "is what the designer"},
    {kCoupling, "design: auto, ^injected_damping_nms_per_rad: 1", "is what the designer"},
    {kCoupling, "design: auto, ^velocity_filter_hz: 50", "is what the designer"},
    {kCoupling, "design: auto, ^velocity_window: 2", "is what the designer"},
    {kCoupling, "design: auto, kind: ^shaping", "did you mean 'shaping_filter'?"},
    {kCoupling, "design: auto, kind: direct, ^cutoff_hz: 5", "'cutoff_hz' goes with kind: auto or shaping_filter, not with direct."},
    {kCoupling, "design: auto, cutoff_hz: ^-5", "'cutoff_hz' is -5"},
    {kCoupling, "design: auto, cutoff_hz: ^500", "it must be below pi"},
    {kCoupling, "design: auto, gain_margin: ^0.5", "'gain_margin' is 0.5; it must be 1 or above."},
    {kCoupling, "design: auto, stiffness_cap_n_per_m: ^-1", "must be above 0"},
    {kCoupling, "design: auto, stiffness_cap_nm_per_rad: ^0", "must be above 0"},
    {kCoupling, "design: auto, hand: ^pencil", "'hand' must be one of: pen, arm, any_passive; here is the word 'pencil'"},
    {kCoupling, "design: auto, hand: ^[0, 1]", "or a map of ranges, but here is a list of 2"},
    {kCoupling, "design: auto, hand: ^{mass_kg: [0, 1]}", "'damping_ns_per_m' is missing in 'hand'."},
    {kCoupling, "design: auto, hand: {^mass: [0, 1]}", "did you mean 'mass_kg'?"},
    {kCoupling, "design: auto, hand: {mass_kg: ^[2, 1], damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1]}", "'mass_kg' goes from 2 to 1; the lower end comes first."},
    {kCoupling, "design: auto, hand: {mass_kg: ^1, damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1]}", "'mass_kg' must be a range [low, high]"},
    {kCoupling, "design: auto, hand: {mass_kg: [0, 1], damping_ns_per_m: [^-1, 1], stiffness_n_per_m: [0, 1]}", "must be 0 or above"},
    {kCoupling, "design: auto, hand: ^{mass_kg: [0, 1], damping_ns_per_m: [0, 1], stiffness_n_per_m: [0, 1], inertia_kg_m2: [0, 1]}", "'damping_nms_per_rad' is missing in 'hand'."},
    {kCoupling, "design: auto, released: ^no", "'released' must be true or false, but here is the word 'no'"},
    {kCoupling, "design: auto, inject_damping: ^1", "'inject_damping' must be true or false"},
    {kCoupling, "design: auto, run_infeasible: ^'true'", "'run_infeasible' must be true or false"},
    {kCoupling, "design: auto, hand: any_passive, ^released: false", "'released: false' does not go with 'hand: any_passive'"},
    {"cutoff_hz: 5", "cutoff_hz: ^500", "w0*T is 3.14 at a sample time of 0.001 s; it must be below pi"},
    {"damping_ratio: 1", "damping_ratio: ^0", "'damping_ratio' is 0; it must be above 0."},
    {"gain: 0.5", "gain: ^0", "'gain' is 0; it must be above 0."},
    {"axis: [0, 0, 2]", "^axis: [0, 0, 0]", "'axis' is the zero vector"},
    {"centre: [0, 0, 0], axis", "^centre: [0.1, 0, 5], axis", "the circle would have no radius"},
    {"path: [[0.1, 0, 0]], circle", "path: ^[], circle", "'path' needs at least one point"},
    {"path: [[0.1, 0, 0]], circle", "path: [[0.1, 0, 0], [0, 1, 0]], repeat_from: 0, ^circle", "'circle' does not go with 'repeat_from'"},
    {"{sphere: {radius: 1}}", "^{sphere: {radius: 1}, box: {size: [1, 1, 1]}}", "A part is exactly one of"},
    // whole files
    {"", "^", "The scene is empty"},
    {"", "^# only a comment\n", "The scene is empty"},
    {"", "^just words", "'scene file' must be a map with the keys: scene,"},
    {"", "^- a\n- b\n", "'scene file' must be a map"},
    {"", "scene: a\n^scene: b\n", "The key 'scene' is here twice; the first is in line 1."},
    {"", "scene: [a\nvoxel_size^: 1\n", "This is no YAML"},
    {"", "scene: 'a^\n", "This is no YAML"},
    {"", "\tscene^: a\n", "This is no YAML"},
    {"", "scene: a\n---\n^scene: b\n", "There is a second YAML document"},
    {"", "scene: ^!!str a\n", "A scene has no tags"},
    {"", "scene: ^&a b\n", "A scene has no anchors"},
    {"", "sc^\xff" "ene: a\n", "The byte 0xff is no text"},
    {"", "scene: a\nvo^\x01xel: 1\n", "The byte 0x01 is no text"},
    {"", "static: ^[]\nscene: a\nvoxel_size: 1\ndynamic: {mesh: a.obj}\ncontact: {stiffness_n_per_m: 1}\n", "'static' needs at least one mesh."},
};

SourcePlace place_at(const std::string& text, std::size_t at) {
  SourcePlace place{1, 1};
  for (std::size_t i = 0; i < at; ++i) {
    ++place.column;
    if (text[i] == '\n') ++place.line, place.column = 1;
  }
  return place;
}

TEST_F(BadScene, SaysWhereAndWhat) {
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
      EXPECT_TRUE(std::string(error.what()).starts_with(head)) << bad.to << "\n  wanted " << head << "\n  got    " << error.what();
      EXPECT_NE(error.sentence().find(bad.says), std::string::npos) << bad.to << "\n  " << error.what();
      EXPECT_TRUE(error.sentence().ends_with('.') || error.sentence().ends_with('?')) << error.what();
      EXPECT_TRUE(error.place().line == place.line && error.place().column == place.column);
    }
  }
  EXPECT_GE(kBad.size(), 90U);
}

TEST_F(BadScene, FilesThatAreNone) {
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      load_scene(file);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(folder_ / "no.yaml"), (folder_ / "no.yaml").string() + ": There is no such scene file.");
  EXPECT_NE(refusal(folder_).find("This is a folder"), std::string::npos);
  EXPECT_NE(refusal("/dev/null").find("no regular file"), std::string::npos);
  EXPECT_NE(refusal("").find("no such scene file"), std::string::npos);
  EXPECT_NE(refusal(write("big.yaml", std::string((1 << 20) + 1, '#'))).find("larger than 1048576 bytes"), std::string::npos);
  EXPECT_NE(refusal(write("edge.yaml", std::string(1 << 20, '#'))).find("The scene is empty"), std::string::npos);
  EXPECT_NE(refusal(write("empty.yaml", "")).find("The scene is empty"), std::string::npos);
  EXPECT_NE(refusal(write("nul.yaml", std::string(100, '\0'))).find(":1:1: The byte 0x00 is no text"), std::string::npos);
  std::string elf = "\x7f" "ELF\x02\x01\x01";
  EXPECT_NE(refusal(write("elf.yaml", elf)).find("is no text"), std::string::npos);
}

/// Small files that stand for huge or endless ones are refused early.
TEST_F(BadScene, BombsDoNotGoOff) {
  std::string bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n";
  for (char c = 'b'; c < 'j'; ++c) {
    bomb.append(1, c).append(": &").append(1, c).append(" [");
    for (int k = 0; k < 9; ++k) bomb.append(k ? ",*" : "*").append(1, static_cast<char>(c - 1));
    bomb.append("]\n");
  }
  EXPECT_THROW(parse(bomb), SceneError);
  for (const int depth : {40, 1000, 10'000, 500'000}) {
    EXPECT_THROW(parse(std::string(static_cast<std::size_t>(depth), '[')), SceneError) << depth;
    EXPECT_THROW(parse("scene: " + std::string(static_cast<std::size_t>(depth), '{')), SceneError) << depth;
  }
  try {
    parse("effects: " + std::string(40, '[') + std::string(40, ']'));
    ADD_FAILURE() << "forty levels were accepted";
  } catch (const SceneError& error) {
    EXPECT_STREQ(error.sentence().c_str(), "The scene is nested more than 32 levels deep.");
    EXPECT_EQ(error.place().column, 41);
  }
  std::string deep;
  for (int k = 0; k < 500; ++k) deep.append(static_cast<std::size_t>(k), ' ').append("a:\n");
  EXPECT_THROW(parse(deep), SceneError);
  std::string dashes;
  for (int k = 0; k < 3000; ++k) dashes += "- ";
  EXPECT_THROW(parse(dashes), SceneError);
  EXPECT_THROW(parse(std::string(300'000, '-')), SceneError);
  std::string many = "effects: [";
  for (int k = 0; k < 300'000; ++k) many += "1,";
  EXPECT_THROW(parse(many + "]"), SceneError);
  std::string keys;
  for (int k = 0; k < 20'000; ++k) keys.append("k").append(std::to_string(k)).append(": 1\n");
  EXPECT_THROW(parse(keys), SceneError);
}

TEST_F(BadScene, NamesOfEveryPlainKindAreTaken) {
  for (const std::string& name : std::vector<std::string>{"cup", "Cup-2.1_b", "7", "a.", "-", std::string(64, 'a')}) {
    std::string text = kSmall;
    text.replace(text.find("small"), 5, "'" + name + "'");
    EXPECT_EQ(parse(text).name, name);
  }
}

/// Its size is looked at before it is read: these two gigabytes are not on the disk, and reading them takes a minute.
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
      EXPECT_NE(error.sentence().find("has 2147483648 bytes, and at most 536870912 are read; reduce the mesh."), std::string::npos)
          << error.what();
      EXPECT_GT(error.place().line, 1);
    }
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.5);  // of this process's own time
  }
}

/// The bytes that are built from are those that the scene's hash tells of.
TEST_F(BadScene, AMeshThatChangesBetweenReadingAndBuildingIsNotTheScenes) {
  const Scene scene = parse(kSmall);
  EXPECT_EQ(scene.mesh_hashes.size(), 2U);
  write("b.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n");
  try {
    rendering::build_scene(scene, serial_for());
    ADD_FAILURE() << "was built";
  } catch (const mesh::MeshError& error) {
    EXPECT_NE(std::string(error.what()).find("b.obj': has changed since the scene was read"), std::string::npos) << error.what();
  }
}

/// Only its JSON stands in the .gltf.
TEST_F(BadScene, AMeshWhoseBufferFileChangesIsAnotherAndIsNotBuilt) {
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
    EXPECT_NE(std::string(error.what()).find("b.gltf': has changed since the scene was read"), std::string::npos) << error.what();
  }
}

TEST_F(BadScene, UnreadableMeshesAreNamed) {
  std::filesystem::create_directory(folder_ / "dir.obj");
  EXPECT_THROW(parse("scene: x\nvoxel_size: 1\nstatic: [{mesh: dir.obj}]\ndynamic: {mesh: b.obj}\ncontact: {stiffness_n_per_m: 1}\n"),
               SceneError);
}

}  // namespace
}  // namespace voxtouch::scene

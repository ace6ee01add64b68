#include "core/scene/scene_file.hpp"

#include <clocale>
#include <cmath>
#include <random>

#include "core/scene/keys.hpp"
#include "core/scene/scene_hash.hpp"
#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::scene {
namespace {

using SceneFile = SceneFolder;

std::string with_voxel_size(const char* number) {
  std::string text = kSmall;
  return text.replace(text.find("0.002"), 5, number);
}

TEST_F(SceneFile, EveryKeyReachesItsField) {
  const auto file = write("full.yaml", kFull);
  const Scene s = load_scene(file);
  EXPECT_EQ(s.name, "full");
  EXPECT_EQ(s.file, file);
  EXPECT_EQ(s.voxel_size_m, 0.002);
  ASSERT_EQ(s.static_meshes.size(), 2U);
  const MeshSpec& a = s.static_meshes[0];
  EXPECT_TRUE(a.path.is_absolute());
  EXPECT_TRUE(std::filesystem::equivalent(a.path, folder_ / "a.obj"));
  EXPECT_EQ(a.scale, 0.5);
  EXPECT_EQ(a.pose.position, Vec3(1, 2, 3));
  EXPECT_NEAR(a.pose.orientation.w(), std::sqrt(0.5), 1e-15) << "normalised";
  EXPECT_NEAR(a.pose.orientation.x(), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(a.pose.orientation.norm(), 1, 1e-15);
  ASSERT_EQ(a.primitives.size(), 3U);
  const auto& sphere = std::get<SpherePrimitive>(a.primitives[0]);
  EXPECT_EQ(sphere.centre, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(sphere.radius_m, 0.04);
  const auto& box = std::get<BoxPrimitive>(a.primitives[1]);
  EXPECT_EQ(box.size_m, Vec3(1, 2, 3));
  EXPECT_EQ(box.pose.position, Vec3(4, 5, 6));
  EXPECT_EQ(box.pose.orientation.x(), 1);
  const auto& cylinder = std::get<CylinderPrimitive>(a.primitives[2]);
  EXPECT_EQ(cylinder.radius_m, 0.5);
  EXPECT_EQ(cylinder.length_m, 2);
  EXPECT_EQ(cylinder.pose.position, Vec3(7, 8, 9));
  EXPECT_EQ(cylinder.pose.orientation.z(), -1);
  EXPECT_EQ(s.static_meshes[1].path.filename(), "b.obj");
  EXPECT_EQ(s.static_meshes[1].scale, 1);
  EXPECT_EQ(s.grid_origin, Vec3(-0.1, -0.2, 0.3));
  EXPECT_EQ(s.dynamic_mesh.path.filename(), "b.obj");
  EXPECT_EQ(s.dynamic_mesh.scale, 0.01);
  EXPECT_EQ(s.dynamic_mesh.pose.position, Vec3(0.01, 0, 0));
  EXPECT_EQ(s.dynamic_mesh.pose.orientation.y(), 1);
  ASSERT_EQ(s.dynamic_mesh.primitives.size(), 1U);
  EXPECT_EQ(std::get<SpherePrimitive>(s.dynamic_mesh.primitives[0]).radius_m, 1);
  EXPECT_EQ(s.shell, ShellKind::kNaive);
  EXPECT_EQ(s.contact.model, "original");
  EXPECT_EQ(s.contact.stiffness_n_per_m, 12.5);
  EXPECT_TRUE(s.effects.empty());
  EXPECT_EQ(s.coupling.kind, "shaping_filter");
  EXPECT_EQ(s.coupling.cutoff_hz, 5);
  EXPECT_EQ(s.coupling.damping_ratio, 1);
  EXPECT_EQ(s.coupling.gain, 0.5);
  EXPECT_EQ(s.device.position_scale, 2);
  EXPECT_EQ(s.device.force_scale, 0.25);
  EXPECT_EQ(s.device.pose_WD.position, Vec3(0, 0, 1));
  EXPECT_EQ(s.device.pose_WD.orientation.z(), 0.5);
  EXPECT_EQ(s.device.pose_PT.position, Vec3(0.1, 0, 0));
  EXPECT_EQ(s.device.pose_PT.orientation.y(), 1);
  EXPECT_EQ(s.device.clutch_button, 1U);
  ASSERT_EQ(s.motions.size(), 2U);
  const Motion& slide = s.motions.at("slide");
  ASSERT_EQ(slide.path.size(), 3U);
  EXPECT_EQ(slide.path[1], Vec3(0.1, 0, 0));
  EXPECT_EQ(slide.speed_m_per_s, 0.1);
  EXPECT_EQ(slide.hold_s, 0.25);
  EXPECT_EQ(slide.repeat_from, 1U);
  EXPECT_EQ(slide.orientation.x(), 1);
  EXPECT_FALSE(slide.circle_centre);
  const Motion& round = s.motions.at("round-1");
  EXPECT_EQ(round.circle_centre, Vec3(0, 0, 0));
  EXPECT_EQ(round.circle_axis, Vec3(0, 0, 1)) << "normalised";
  EXPECT_EQ(round.speed_m_per_s, 0.07);
  EXPECT_FALSE(round.repeat_from);
  EXPECT_TRUE(s.warnings.empty());
}

TEST_F(SceneFile, OmittedKeysKeepTheirDefaults) {
  const Scene s = parse(kSmall), none;
  EXPECT_EQ(s.shell, ShellKind::kExact);
  EXPECT_EQ(s.contact.model, "adapted");
  EXPECT_EQ(s.coupling.kind, none.coupling.kind);
  EXPECT_EQ(s.coupling.cutoff_hz, none.coupling.cutoff_hz);
  EXPECT_EQ(s.device.position_scale, 1);
  EXPECT_FALSE(s.device.clutch_button);
  EXPECT_FALSE(s.grid_origin);
  EXPECT_TRUE(s.motions.empty());
  EXPECT_EQ(s.dynamic_mesh.scale, 1);
}

TEST_F(SceneFile, StiffnessFollowsTheBodysMassIfNoneIsGiven) {
  const auto with_contact = [&](const std::string& keys) {
    std::string text = kSmall + "coupling: {design: auto}\neffects: [{body: {mass_kg: 0.256}}]\n";
    const std::size_t at = text.find("contact:");
    return parse(text.replace(at, text.find('\n', at) - at, "contact: {" + keys + "}"));
  };
  const Scene follows = with_contact("model: field");
  EXPECT_FALSE(follows.virtual_tool());
  EXPECT_EQ(follows.contact.body_mass_kg, 0.256);
  EXPECT_EQ(with_contact("model: field, stiffness_n_per_m3: 1e6").contact.body_mass_kg, 0.0);
  EXPECT_THROW(with_contact("model: field, rendering: virtual_tool"), SceneError);
}

TEST_F(SceneFile, FieldIsAVirtualToolUnlessAStiffnessIsGiven) {
  const auto with_contact = [&](const std::string& keys) {
    std::string text = kSmall + "coupling: {design: auto}\n";
    const std::size_t at = text.find("contact:");
    return parse(text.replace(at, text.find('\n', at) - at, "contact: {" + keys + "}"));
  };
  EXPECT_TRUE(with_contact("model: field").virtual_tool());
  EXPECT_TRUE(with_contact("rendering: virtual_tool").virtual_tool());
  EXPECT_FALSE(with_contact("model: field, stiffness_n_per_m3: 1e6").virtual_tool());
  EXPECT_FALSE(
      with_contact("model: field, rendering: penalty, stiffness_n_per_m3: 1e6").virtual_tool());
  EXPECT_FALSE(with_contact("model: adapted, stiffness_n_per_m: 10").virtual_tool());
  EXPECT_EQ(with_contact("model: adapted, stiffness_n_per_m: 10").contact.rendering,
            RenderingKind::kPenalty);
  EXPECT_EQ(with_contact("model: adapted, stiffness_n_per_m: 10, rendering: memoryless")
                .contact.rendering,
            RenderingKind::kMemoryless);
  EXPECT_EQ(with_contact("model: field, stiffness_n_per_m3: 1e6, rendering: memoryless")
                .contact.rendering,
            RenderingKind::kMemoryless);
}

/// The table prints the initialiser of the member that the key is read into, and of no other.
TEST_F(SceneFile, APrintedStandardMeansTheSameAsLeavingItOut) {
  for (const Key& key : keys::coupling.keys) {
    if (key.standard == nullptr)
      continue;
    std::string given = std::string(key.name) + ": " + key.standard();
    if (key.rule == KeyRule::kWithFirst) {
      EXPECT_EQ(*parse(kSmall + "coupling: {design: auto, " + given + "}\n").design,
                DesignOptions())
          << given;
      continue;
    }
    coupling::CouplingSpec spec;
    if (key.name == "stiffness_n_per_m" || key.name == "damping_ns_per_m")
      spec.kind = "spring_damper";
    if (key.name.find("velocity") != key.name.npos) {
      given += ", injected_damping_ns_per_m: 1";
      spec.injected_damping_ns_per_m = 1.0;
    }
    EXPECT_EQ(parse(kSmall + "coupling: {kind: " + spec.kind + ", " + given + "}\n").coupling, spec)
        << given;
  }
  for (const Key& key : keys::device.keys) {
    if (key.standard == nullptr)
      continue;
    EXPECT_EQ(
        parse(kSmall + "device: {" + std::string(key.name) + ": " + key.standard() + "}\n").device,
        WorkspaceMapping())
        << key.name;
  }
}

TEST_F(SceneFile, OtherCouplingsTakeTheirOwnKeys) {
  const Scene s = parse(
      kSmall + "coupling: {kind: spring_damper, stiffness_n_per_m: 300, damping_ns_per_m: 0}\n");
  EXPECT_EQ(s.coupling.kind, "spring_damper");
  EXPECT_EQ(s.coupling.stiffness_n_per_m, 300);
  EXPECT_EQ(s.coupling.damping_ns_per_m, 0);
  EXPECT_EQ(parse(kSmall + "coupling: {kind: direct}\n").coupling.kind, "direct");
}

TEST_F(SceneFile, WarnsOfACutoffNearTheSampleRate) {
  const Scene s = parse(kSmall + "coupling: {cutoff_hz: 200}\n");
  ASSERT_EQ(s.warnings.size(), 1U);
  EXPECT_NE(s.warnings[0].find("s.yaml:6:23: cutoff_hz is 200"), std::string::npos)
      << s.warnings[0];
}

TEST_F(SceneFile, NumbersMayBeWrittenInEveryPlainFormat) {
  for (const char* text : {"0.25", ".25", "2.5e-1", "+0.25", "25E-2", "0.250000", "00.25"}) {
    const Scene s = parse(with_voxel_size(text));
    EXPECT_EQ(s.voxel_size_m, 0.25) << text;
  }
}

TEST_F(SceneFile, LineEndsOfWindowsAndAByteOrderMarkAreRead) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : kFull) {
    if (c == '\n')
      text.push_back('\r');
    text.push_back(c);
  }
  EXPECT_EQ(parse(text).motions.size(), 2U);
}

/// A comma for the point in the process's locale changes no number.
TEST_F(SceneFile, NoLocaleChangesANumber) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const char* found = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "ru_RU.UTF-8"})
    if (found == nullptr)
      found = std::setlocale(LC_ALL, name);
  if (found == nullptr) {
    // None installed: make one in the test's folder.
    std::string make = "localedef -i de_DE -f UTF-8 '";
    make.append((folder_ / "de_DE.UTF-8").string()).append("' >/dev/null 2>&1");
    if (std::system(make.c_str()) >= 0) {
      setenv("LOCPATH", folder_.c_str(), 1);
      found = std::setlocale(LC_ALL, "de_DE.UTF-8");
    }
  }
  ASSERT_NE(found, nullptr) << "no locale with a decimal comma: is the package 'locales' of "
                               "deploy/packages.txt installed?";
  EXPECT_EQ(std::string(std::localeconv()->decimal_point), ",") << "the locale is in force";
  const Scene s = parse(kFull);
  std::string message;
  try {
    parse(with_voxel_size("-0.5"));
  } catch (const SceneError& error) {
    message = error.sentence();
  }
  std::setlocale(LC_ALL, before.c_str());
  unsetenv("LOCPATH");
  EXPECT_EQ(s.voxel_size_m, 0.002);
  EXPECT_EQ(s.contact.stiffness_n_per_m, 12.5);
  EXPECT_NE(message.find("-0.5"), std::string::npos)
      << "messages keep the point as well: " << message;
  EXPECT_EQ(s.hash, parse(kFull).hash);
}

TEST_F(SceneFile, HashDependsOnContentOnly) {
  write("s.yaml", kFull);
  const std::string hash = load_scene(folder_ / "s.yaml").hash;
  EXPECT_EQ(hash.size(), 16U);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(parse(kFull).hash, hash);
  const auto other = folder_ / "elsewhere";
  std::filesystem::create_directory(other);
  for (const char* name : {"s.yaml", "a.obj", "b.obj"})
    std::filesystem::copy_file(folder_ / name, other / name);
  std::filesystem::rename(other / "s.yaml", other / "renamed.yaml");
  EXPECT_EQ(load_scene(other / "renamed.yaml").hash, hash);
  EXPECT_NE(parse(kFull + "# a comment\n").hash, hash);
  write("b.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n");
  EXPECT_NE(parse(kFull).hash, hash);
}

TEST(SceneHash, IsFnv1aOverPartsWithTheirLengths) {
  EXPECT_EQ(SceneHash().hex(), "cbf29ce484222325");
  SceneHash one, two;
  one.add("ab"), one.add("c");
  two.add("a"), two.add("bc");
  EXPECT_NE(one.hex(), two.hex());
  SceneHash known;  // FNV-1a of "a" followed by its length 1 in eight bytes
  known.add("a");
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const std::uint64_t c : {0x61, 1, 0, 0, 0, 0, 0, 0, 0})
    h = (h ^ c) * 0x100000001b3ULL;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  EXPECT_EQ(known.hex(), text);
}

/// A scene cut off anywhere is either still a scene or an error with a place in it.
TEST_F(SceneFile, CutOffAnywhereLoadsOrReportsWhy) {
  int loaded = 0, refused = 0;
  for (const std::string& whole : {kFull, kSmall}) {
    for (std::size_t n = 0; n <= whole.size(); ++n) {
      try {
        parse(whole.substr(0, n));
        ++loaded;
      } catch (const SceneError& error) {
        ++refused;
        EXPECT_GE(error.place().line, 1) << n;
        EXPECT_GE(error.place().column, 1) << n;
      }
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(loaded, 1);
}

/// Bytes changed, lines swapped, pieces doubled: SceneError is the only exception.
TEST_F(SceneFile, MangledScenesAreAnErrorAtWorst) {
  std::mt19937_64 random(31);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::string spice = "{}[]:,-&*!|>'\"%@`?# \t\n\0\x7f\xff.eE+0123456789";
  for (int attempt = 0; attempt < 4000; ++attempt) {
    std::string text = kFull;
    for (std::size_t k = 0; k <= below(4); ++k) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = spice[below(spice.size())];
          break;
        case 1:
          text.insert(at, 1, spice[below(spice.size())]);
          break;
        case 2:
          text.erase(at, 1 + below(20));
          break;
        default:
          text.insert(at, text.substr(below(text.size()), below(60)));
      }
      if (text.empty())
        text.push_back('x');
    }
    try {
      const Scene s = parse(text);
      EXPECT_TRUE(std::isfinite(s.voxel_size_m) && s.voxel_size_m > 0);
      EXPECT_EQ(s.hash.size(), 16U);
    } catch (const SceneError&) {
    }
  }
}

}  // namespace
}  // namespace voxtouch::scene

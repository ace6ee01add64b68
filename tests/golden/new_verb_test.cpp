/// `voxtouch new`: the file that it writes runs unchanged.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

const std::filesystem::path kMeshes = std::filesystem::path(VOXTOUCH_DEPLOY) / "meshes";

class NewVerb : public testing::TestWithParam<const char*> {};

TEST_P(NewVerb, WritesASceneReadyToTouch) {
  const TemporaryFolder out;
  const std::filesystem::path scene = out / "mine.yaml";
  const Finished made = voxtouch({"new", (kMeshes / GetParam()).string(), "--out", scene.string()});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.out.find("Correct by hand"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find("the virtual tool stays"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find("Certified: "), std::string::npos) << made.out;
  for (const char* motion : {"press", "slide"}) {
    const Finished run =
        voxtouch({"up", scene.string(), "--motion", motion, "--lockstep", "--duration", "3",
                  "--no-record", "--one-process", "--domain", "55", "--json"});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_GT(nlohmann::json::parse(run.out).at("max_force_n").get<double>(), 0.2) << motion;
  }
}
INSTANTIATE_TEST_SUITE_P(
    Shipped, NewVerb, testing::Values("cup_mm.stl", "block.obj", "plane.obj", "cylinder.obj"),
    [](const auto& test) {
      return std::string(test.param).substr(0, std::string(test.param).find('.'));
    });

TEST(NewVerb, NeverWritesOverAFile) {
  const TemporaryFolder out;
  const std::filesystem::path scene = out / "mine.yaml";
  std::ofstream(scene) << "mine\n";
  const Finished made =
      voxtouch({"new", (kMeshes / "block.obj").string(), "--out", scene.string()});
  EXPECT_EQ(made.status, 1);
  EXPECT_EQ(file_text(scene), "mine\n");
}

/// The folder of a part and its scene can be moved, and holds no path of this machine.
TEST(NewVerb, WritesASceneThatCanBeMoved) {
  const TemporaryFolder out;
  std::filesystem::create_directories(out / "first" / "scenes");
  const std::filesystem::path part = out / "first" / "block.obj",
                              scene = out / "first" / "scenes" / "mine.yaml";
  std::filesystem::copy(kMeshes / "block.obj", part);
  const Finished made = voxtouch({"new", part.string(), "--out", scene.string()});
  ASSERT_EQ(made.status, 0) << made.err;
  std::istringstream lines(file_text(scene));
  for (std::string line; std::getline(lines, line);) {
    if (line.find("mesh:") != std::string::npos) {
      EXPECT_EQ(line.find("\"/"), std::string::npos) << line;
    }
  }
  std::filesystem::rename(out / "first", out / "second");
  const std::filesystem::path moved = out / "second" / "scenes" / "mine.yaml";
  const Finished plan = voxtouch({"plan", moved.string()});
  EXPECT_EQ(plan.status, 0) << plan.out << plan.err;
  EXPECT_EQ(file_text(out / "second" / "scenes" / "mine.tool.obj"),
            file_text(kMeshes / "sphere.obj"));
}

TEST(NewVerb, KeepsAForeignFileWithTheToolsName) {
  const TemporaryFolder out;
  const std::filesystem::path scene = out / "mine.yaml", tool = out / "mine.tool.obj";
  std::ofstream(tool) << "mine\n";
  const Finished made =
      voxtouch({"new", (kMeshes / "block.obj").string(), "--out", scene.string()});
  EXPECT_EQ(made.status, 1);
  EXPECT_NE(made.err.find("mine.tool.obj"), std::string::npos) << made.err;
  EXPECT_EQ(file_text(tool), "mine\n");
  EXPECT_FALSE(std::filesystem::exists(scene));
}

/// A box of `length` of the file's units, in COLLADA.
std::string collada_box(const std::string& unit, double length) {
  std::string numbers;
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis)
      numbers += fmt::format("{} ", corner >> axis & 1 ? length : 0.0);
  }
  return fmt::format(
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{}</asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="24">{}</float_array><technique_common>
<accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4 4 4 4 4</vcount>
<p>0 2 3 1 4 5 7 6 0 1 5 4 2 6 7 3 0 4 6 2 1 3 7 5</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>)",
      unit, numbers);
}

TEST(NewVerb, UsesTheUnitDeclaredInAFile) {
  const TemporaryFolder out;
  const std::filesystem::path part = out / "part.dae", scene = out / "mine.yaml";
  const struct {
    const char* unit;
    double length;
    const char* metres;
  } rows[] = {{R"(<unit name="meter" meter="1"/>)", 20, "20 m"},
              {R"(<unit name="inch" meter="0.0254"/>)", 1000, "25.4 m"},
              {R"(<unit name="centimeter" meter="0.01"/>)", 800, "8 m"},
              {R"(<unit name="millimeter" meter="0.001"/>)", 80, "0.08 m"},
              {"", 6, "6 m"}};  // metres, by the standard
  for (const auto& row : rows) {
    std::ofstream(part) << collada_box(row.unit, row.length);
    const Finished made = voxtouch({"new", part.string(), "--out", scene.string()});
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_NE(made.out.find(std::string("part.dae: largest extent ") + row.metres),
              std::string::npos)
        << made.out;
    std::filesystem::remove(scene);
  }
}

TEST(NewVerb, WarnsIfSinglePrecisionIsTooCoarse) {
  const TemporaryFolder out;
  const std::filesystem::path part = out / "map.obj";
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    text += fmt::format("v {} {} {}\n", 500000.0 + 20.0 * (corner & 1),
                        4500000.0 + 20.0 * (corner >> 1 & 1), 20.0 * (corner >> 2));
  }
  std::ofstream(part) << text
                      << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const Finished made =
      voxtouch({"new", part.string(), "--unit", "m", "--out", (out / "mine.yaml").string()});
  EXPECT_NE(made.err.find("single precision"), std::string::npos) << made.out << made.err;
  EXPECT_NE(made.err.find("4.5e+06 m"), std::string::npos) << made.err;
}

}  // namespace
}  // namespace voxtouch::test

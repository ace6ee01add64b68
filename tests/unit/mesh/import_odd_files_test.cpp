/// Complete files in an unusual form are read as the shape that they contain; files whose shape
/// would silently change are refused.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/import.hpp"
#include "samples.hpp"
#include "tests/support/facts.hpp"

using namespace voxtouch;
using samples::Collada;
using samples::Folder;
using samples::Gltf;
using samples::tetrahedron;

namespace {

const std::string kMark = "\xef\xbb\xbf";
const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n";
const std::string kPly =
    kPlyHead +
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 "
    "1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

class OddFile : public ::testing::Test {
 protected:
  /// `reported`: text of the expected warning; empty: none.
  void expect_tetrahedron(const std::string& name, const std::string& bytes,
                          const std::string& reported) {
    SCOPED_TRACE(name);
    try {
      const mesh::ImportedMesh got = mesh::import_mesh(folder_.write(name, bytes));
      ASSERT_EQ(got.mesh.triangles.size(), 4U);
      for (std::size_t t = 0; t < 4; ++t) {
        for (int k = 0; k < 3; ++k)
          EXPECT_EQ(got.mesh.corner(t, k), tetrahedron().corner(t, k));
      }
      EXPECT_TRUE(got.report.clean());
      ASSERT_EQ(got.warnings.size(), reported.empty() ? 0U : 1U)
          << (got.warnings.empty() ? "" : got.warnings[0]);
      if (!reported.empty()) {
        EXPECT_NE(got.warnings[0].find(reported), std::string::npos) << got.warnings[0];
      }
    } catch (const mesh::MeshError& refused) {
      ADD_FAILURE() << refused.what();
    }
  }
  void expect_refused(const std::string& name, const std::string& bytes, const std::string& facts) {
    SCOPED_TRACE(name);
    try {
      mesh::import_mesh(folder_.write(name, bytes));
      ADD_FAILURE() << "read";
    } catch (const mesh::MeshError& refused) {
      EXPECT_EQ(test::missing_fact(refused.what(), facts), "") << refused.what();
    }
  }
  Folder folder_;
};

TEST_F(OddFile, WithAByteOrderMarkKeepsItsFirstStatement) {
  const std::string reported = "byte order mark";
  expect_tetrahedron("t.obj", kMark + samples::obj_text(tetrahedron()), reported);
  expect_tetrahedron("t.stl", kMark + samples::text_stl(tetrahedron()), reported);
  expect_tetrahedron("t.ply", kMark + kPly, reported);
  expect_tetrahedron("t.dae", kMark + Collada().xml(), reported);
  expect_tetrahedron("t.glb", kMark + Gltf().glb(), reported);
  folder_.write("t.bin", samples::gltf_buffer());
  Gltf two;
  two.buffer = R"({"byteLength":72,"uri":"t.bin"})";
  expect_tetrahedron("t.gltf", kMark + two.json(), reported);
  std::string header = samples::binary_stl(tetrahedron());
  expect_tetrahedron("header.stl", header.replace(0, 3, kMark), "");  // any header is right there
}

TEST_F(OddFile, OfStlTextIsReadWithAnyKeywords) {
  const std::string text = samples::text_stl(tetrahedron());
  expect_tetrahedron("plain.stl", text, "");
  expect_tetrahedron("upper.stl", upper(text), "capitals");
  expect_tetrahedron("end.stl", replaced(text, "endsolid", "ENDSOLID"), "capitals");
  expect_tetrahedron("two_words.stl", replaced(text, "endsolid", "end solid"), "");
  expect_tetrahedron("words.stl",
                     replaced(replaced(text, "endloop", "end loop"), "endfacet", "end  facet"), "");
  expect_tetrahedron("nan.stl", replaced(text, "normal 0 0 0", "normal -nan(ind) -nan(ind) nan"),
                     "4 normals");
  expect_tetrahedron("inf.stl", replaced(text, "normal 0 0 0", "normal 1.#INF 0 -1.#IND"),
                     "4 normals");
  const std::string named =
      replaced(text, "solid sample", "solid Geh\xc3\xa4use f\xc3\xbcr den endloop facet");
  expect_tetrahedron("keywords_in_name.stl", named, "");
  expect_tetrahedron("lines.stl", replaced(text, "\n", "\r"), "");
  expect_tetrahedron("blank_start.stl", "\r\n\n  \t" + text, "");
  expect_tetrahedron("padded.stl", text + std::string(100, '\0'), "100 padding bytes");
  expect_tetrahedron("old.stl", text + "\x1a", "1 padding bytes");
}

TEST_F(OddFile, OfBinaryStlMayHaveBytesBehindItsTriangles) {
  const std::string binary = samples::binary_stl(tetrahedron());
  expect_tetrahedron("zeros.stl", binary + std::string(92, '\0'), "92 bytes");
  expect_tetrahedron("note.stl", binary + "made by hand", "12 bytes");
  expect_tetrahedron("zero_triangles.stl", binary + std::string(100, '\0'), "100 bytes");
  // More triangles than the header counts are no remainder.
  std::string fewer = binary;
  expect_refused("fewer.stl", fewer.replace(80, 1, "\3"), "3 triangles|bytes for 4");
}

TEST_F(OddFile, OfObjMayHaveCapitalsAndAnyLineEnds) {
  const std::string text = samples::obj_text(tetrahedron());
  expect_tetrahedron("upper.obj", upper(text), "");
  // Objects, by which assimp would sort the faces.
  expect_tetrahedron(
      "mac.obj",
      "v 0 0 0\rv 1 0 0\rv 0 1 0\rv 0 0 1\ro A\rusemtl x\rf 1 3 2\ro B\rusemtl y\rf 1 2 4\r"
      "o A\rusemtl x\rf 1 4 3\ro B\rf 2 3 4\r",
      "");
  expect_tetrahedron("dos.obj", replaced(text, "\n", "\r\n"), "");
  expect_tetrahedron("padded.obj", text + std::string(7, '\0'), "7 padding bytes");
}

TEST_F(OddFile, WithNonPolygonalSurfacesIsRefused) {
  const std::string text = samples::obj_text(tetrahedron());
  expect_refused("surface.obj", text + "cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\n", "'surf'");
  expect_refused("call.obj", text + "call other.obj\n", "'call'");
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  expect_refused("strips.ply",
                 kPlyHead +
                     "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                     vertices + "8 0 2 1 -1 0 1 3 -1\n",
                 "'tristrips'|polygons");
  expect_refused("fans.ply",
                 kPlyHead +
                     "element face 1\nproperty list uchar int vertex_indices\nelement trifans "
                     "1\nproperty list uchar int "
                     "vertex_index\nend_header\n" +
                     vertices + "3 0 2 1\n4 0 1 3 2\n",
                 "'trifans'");
  expect_refused("twice.ply",
                 kPlyHead +
                     "element face 1\nproperty list uchar int vertex_indices\nelement face "
                     "1\nproperty list uchar int "
                     "vertex_indices\nend_header\n" +
                     vertices + "3 0 2 1\n3 0 1 3\n",
                 "'face' twice");
  Collada hull;
  expect_refused(
      "hull.dae",
      replaced(replaced(hull.xml(), "<mesh>", "<convex_mesh>"), "</mesh>", "</convex_mesh>"),
      "convex hull");
  Collada fans;
  fans.kind = "trifans", fans.faces = "1", fans.p = "0 2 1 3 2";
  expect_refused("fans.dae", fans.xml(), "triangle fans");
  for (const char* unit : {"0", "-1", "0,01", "nan"}) {
    Collada file;
    file.unit = std::string("<unit name=\"x\" meter=\"") + unit + "\"/>";
    expect_refused("unit.dae", file.xml(), std::string("unit|'") + unit + "'");
  }
}

TEST_F(OddFile, ShapedByAnotherPartIsRefused) {
  const auto gltf = [](const std::string& from, const std::string& to) {
    std::string json = replaced(Gltf().json(), from, to);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto size = static_cast<std::uint32_t>(json.size());
    return "glTF" + samples::little<std::uint32_t>({2, 12 + 8 + size + 8 + 72, size}) + "JSON" +
           json + samples::little<std::uint32_t>({72}) + std::string("BIN\0", 4) +
           samples::gltf_buffer();
  };
  const std::string asset = R"("asset":{"version":"2.0"})";
  expect_refused("required.glb", gltf(asset, asset + R"(,"extensionsRequired":["EXT_unheard_of"])"),
                 "'EXT_unheard_of'");
  expect_refused("draco.glb",
                 gltf(asset, asset + R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"),
                 "'KHR_draco_mesh_compression'");
  expect_tetrahedron("material.glb",
                     gltf(asset, asset + R"(,"extensionsRequired":["KHR_materials_unlit"])"), "");
  const std::string node = R"({"mesh":0})";
  expect_refused(
      "instances.glb",
      gltf(
          node,
          R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}})"),
      "node 0|EXT_mesh_gpu_instancing");
  expect_refused("hidden.glb",
                 gltf(node, R"({"mesh":0,"extensions":{"KHR_node_visibility":{"visible":false}}})"),
                 "node 0|KHR_node_visibility");
  expect_refused("skin.glb", gltf(node, R"({"mesh":0,"skin":0})"), "node 0|skin");
  expect_refused("weights.glb", gltf(node, R"({"mesh":0,"weights":[0.5]})"), "node 0|morph");
  expect_refused("morph.glb", gltf(R"({"primitives")", R"({"weights":[0,1],"primitives")"),
                 "mesh 0|morph");
  expect_tetrahedron("at_rest.glb", gltf(R"({"primitives")", R"({"weights":[0,0],"primitives")"),
                     "");
  Collada skin;
  skin.nodes =
      R"(<node id="n"><instance_geometry url="#g"/><instance_controller url="#c"/></node>)";
  expect_refused("skin.dae", skin.xml(), "skinned|'n'");
  skin.nodes = R"(<node id="n"><skew>45 0 1 0 1 0 0</skew><instance_geometry url="#g"/></node>)";
  expect_refused("skew.dae", skin.xml(), "shears|'n'");
}

TEST_F(OddFile, OfGltfWithoutASceneUsesItsNodes) {
  const std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  folder_.write("t.bin", samples::gltf_buffer());
  Gltf two;
  two.buffer = R"({"byteLength":72,"uri":"t.bin"})";
  expect_tetrahedron("no_scene.gltf", replaced(two.json(), scene, ""), "no default scene");
  expect_tetrahedron("no_node.gltf",
                     replaced(replaced(two.json(), scene, ""), R"("nodes":[{"mesh":0}],)", ""),
                     "no default scene");
  two.nodes = R"([{"children":[1],"translation":[-1,0,0]},{"mesh":0,"translation":[1,0,0]}])";
  expect_tetrahedron("child.gltf", replaced(two.json(), scene, ""), "no default scene");
  std::string json = replaced(Gltf().json(), scene, "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto size = static_cast<std::uint32_t>(json.size());
  expect_tetrahedron("no_scene.glb",
                     "glTF" + samples::little<std::uint32_t>({2, 12 + 8 + size + 8 + 72, size}) +
                         "JSON" + json + samples::little<std::uint32_t>({72}) +
                         std::string("BIN\0", 4) + samples::gltf_buffer(),
                     "no default scene");
}

TEST_F(OddFile, OfGltfWithoutAMeshInItsSceneIsRefused) {
  const std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  expect_refused("empty.glb.gltf",
                 replaced(Gltf().json(), scene, R"("scene":1,"scenes":[{"nodes":[0]},{}],)"),
                 "default scene, number 1, contains no mesh");
}

/// Strips of triangles are linked by triangles without area, which may cross the inside.
TEST_F(OddFile, OfGltfMayLinkTheStripsOfItsTriangles) {
  const std::string strip = samples::little<std::uint16_t>(
      {0, 2, 1, 1, 1, 0, 0, 1, 3, 3, 3, 0, 0, 3, 2, 2, 2, 1, 1, 2, 3});
  folder_.write("strip.bin", samples::gltf_buffer().substr(0, 48) + strip);
  Gltf linked;
  linked.buffer = R"({"byteLength":90,"uri":"strip.bin"})";
  linked.indices = R"({"bufferView":1,"componentType":5123,"count":21,"type":"SCALAR"})";
  const std::string json =
      replaced(replaced(linked.json(), R"("byteLength":24)", R"("byteLength":42)"),
               R"("indices":1})", R"("indices":1,"mode":5})");
  expect_tetrahedron("strip.gltf", json, "with two equal corners are skipped");
}

TEST_F(OddFile, OfGltfMayNameItsBufferInPercentCode) {
  Gltf two;
  folder_.write("my mesh \xc3\xa4.bin", samples::gltf_buffer());
  two.buffer = R"({"byteLength":72,"uri":"my%20mesh%20%C3%A4.bin"})";
  expect_tetrahedron("t.gltf", two.json(), "");
  folder_.write("100%25.bin", samples::gltf_buffer());  // a file that is called so
  two.buffer = R"({"byteLength":72,"uri":"100%25.bin"})";
  expect_tetrahedron("u.gltf", two.json(), "");
  two.buffer = R"({"byteLength":72,"uri":"gone%20.bin"})";
  expect_refused("v.gltf", two.json(), "gone");
}

TEST_F(OddFile, OfColladaMayHavePolygonsWithHoles) {
  Collada file;
  std::string xml = file.xml();
  const auto set = [&](const std::string& from, const std::string& to) {
    xml = replaced(xml, from, to);
  };
  set("0 0 0 1 0 0 0 1 0 0 0 1</float_array>",
      "0 0 0 4 0 0 4 4 0 0 4 0 1 1 0 1 3 0 3 3 0 3 1 0</float_array>");
  set("count=\"12\"", "count=\"24\"");
  set("count=\"4\" stride", "count=\"8\" stride");
  set("<triangles count=\"4\">", "<polygons count=\"1\">");
  set("</triangles>", "</polygons>");
  set("<p>0 2 1 0 1 3 0 3 2 1 2 3</p>", "<ph><p>0 1 2 3</p><h>4 5 6 7</h></ph>");
  const mesh::ImportedMesh got = mesh::import_mesh(folder_.write("frame.dae", xml));
  EXPECT_EQ(got.mesh.triangles.size(), 8U);
  double area = 0.0;
  for (std::size_t t = 0; t < got.mesh.triangles.size(); ++t) {
    const Vec3 a = got.mesh.corner(t, 0);
    area += 0.5 * (got.mesh.corner(t, 1) - a).cross(got.mesh.corner(t, 2) - a).z();
  }
  EXPECT_NEAR(area, 12.0, 1e-12);
  EXPECT_EQ(got.report.open_edges.count, 8U);
}

TEST_F(OddFile, OfObjWithWeightsOtherThanOneIsRefused) {
  const std::string faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  expect_tetrahedron("one.obj", "v 0 0 0 1\nv 1 0 0 1.0\nv 0 1 0 1e0 # corner\nv 0 0 1\n" + faces,
                     "");
  expect_tetrahedron("colours.obj",
                     "v 0 0 0 .5 .5 .5\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nv 0 0 1 0 0 1\n" + faces, "");
  expect_refused("half.obj", "v 0 0 0\nV 1 0 0 0.5\nv 0 1 0\nv 0 0 1\n" + faces, "weight|'0.5'");
}

TEST_F(OddFile, WithoutAMeshIsNamedByItsType) {
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\noid sha256:" + std::string(64, '0') +
      "\nsize 1\n";
  for (const char* name : {"t.obj", "t.stl", "t.ply", "t.gltf", "t.glb", "t.dae"}) {
    expect_refused(name, pointer, "git-lfs pointer|git lfs pull");
    expect_refused(name, "<!DOCTYPE HTML>\n<html></html>\n", "web page");
    expect_refused(name, std::string("\x1f\x8b\x08\0\0\0", 6), "gzip");
    expect_refused(name, std::string("PK\x03\x04\0\0", 6), "ZIP");
    expect_refused(name, std::string("\xff\xfev\0 \0", 6), "UTF-16");
    expect_refused(name, "ISO-10303-21;\nHEADER;\n", "STEP");
  }
  expect_refused("t.obj", kPly, "PLY|.ply");
  expect_refused("t.gltf", Gltf().glb(), "binary glTF|.glb");
}

}  // namespace

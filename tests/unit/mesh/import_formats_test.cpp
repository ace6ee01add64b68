/// One tetrahedron in every format; units, axes and nodes.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/mesh/import.hpp"
#include "samples.hpp"

using namespace voxtouch;
using samples::Collada;
using samples::Folder;
using samples::Gltf;
using samples::tetrahedron;

namespace {

void expect_tetrahedron(const mesh::ImportedMesh& got, double scale = 1.0,
                        const Vec3& shift = Vec3::Zero()) {
  const mesh::TriangleMesh t = tetrahedron();
  ASSERT_EQ(got.mesh.triangles.size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 expected = scale * t.corner(f, k) + shift;
      EXPECT_LE((got.mesh.corner(f, k) - expected).cwiseAbs().maxCoeff(),
                scale == 1.0 ? 0.0 : 1e-7 * scale)
          << f << ' ' << k;
    }
  }
  EXPECT_TRUE(got.report.clean());
  EXPECT_EQ(got.mesh.vertices.size(), 4u);
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
}

TEST(ImportFormats, ReadObj) {
  const Folder folder;
  expect_tetrahedron(mesh::import_mesh(folder.write("t.obj", samples::obj_text(tetrahedron()))));
  expect_tetrahedron(
      mesh::import_mesh(folder.write("UPPER.OBJ", samples::obj_text(tetrahedron()))));
}

TEST(ImportFormats, ReadStlAsTextAndBinary) {
  const Folder folder;
  expect_tetrahedron(mesh::import_mesh(folder.write("text.stl", samples::text_stl(tetrahedron()))));
  expect_tetrahedron(
      mesh::import_mesh(folder.write("binary.stl", samples::binary_stl(tetrahedron()))));
  std::string misleading = samples::binary_stl(tetrahedron());
  misleading.replace(0, 5, "solid");  // some tools begin binary files like text
  expect_tetrahedron(mesh::import_mesh(folder.write("misleading.stl", misleading)));
  mesh::TriangleMesh first = tetrahedron(), second = tetrahedron();
  first.triangles.resize(2),
      second.triangles.erase(second.triangles.begin(), second.triangles.begin() + 2);
  expect_tetrahedron(mesh::import_mesh(
      folder.write("two.stl", samples::text_stl(first) + samples::text_stl(second))));
}

TEST(ImportFormats, ReadPlyAsTextAndInBothByteOrders) {
  const Folder folder;
  expect_tetrahedron(mesh::import_mesh(folder.write(
      "text.ply",
      ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")));
  for (const bool big : {false, true}) {
    std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
    const auto add = [&](std::string number) {
      if (big)
        std::reverse(number.begin(), number.end());
      bytes += number;
    };
    for (const Vec3& v : tetrahedron().vertices) {
      for (int k = 0; k < 3; ++k)
        add(samples::little({static_cast<float>(v[k])}));
    }
    for (const auto& t : tetrahedron().triangles) {
      bytes += '\3';
      for (const std::uint32_t v : t)
        add(samples::little({v}));
    }
    expect_tetrahedron(mesh::import_mesh(folder.write(big ? "big.ply" : "little.ply", bytes)));
  }
}

TEST(ImportFormats, ReadPlyWithAnUnusedVertex) {
  const Folder folder;
  std::string text = ply_header("ascii");
  text.replace(text.find("vertex 4"), 8, "vertex 5");
  const mesh::ImportedMesh got = mesh::import_mesh(folder.write(
      "t.ply", text + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"));
  EXPECT_EQ(got.report.unused_vertices.count, 1u);
  EXPECT_EQ(got.report.max, Vec3(1, 1, 1));
  EXPECT_TRUE(got.report.closed);
}

TEST(ImportFormats, ReadGltfInOneFileAndInTwo) {
  const Folder folder;
  expect_tetrahedron(mesh::import_mesh(folder.write("t.glb", Gltf().glb())));
  folder.write("t.bin", samples::gltf_buffer());
  Gltf two;
  two.buffer = R"({"byteLength":72,"uri":"t.bin"})";
  expect_tetrahedron(mesh::import_mesh(folder.write("t.gltf", two.json())));
}

TEST(ImportFormats, GltfIsInMetresWithItsAxesAsTheyAre) {
  const Folder folder;
  Gltf moved;
  moved.nodes = R"([{"children":[1],"scale":[2,2,2]},{"mesh":0,"translation":[1,2,3]}])";
  expect_tetrahedron(mesh::import_mesh(folder.write("t.glb", moved.glb())), 2.0, {2, 4, 6});
}

TEST(ImportFormats, AMirroringNodeKeepsTrianglesFacingOutward) {
  const Folder folder;
  Gltf mirrored;
  mirrored.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
  const mesh::ImportedMesh got = mesh::import_mesh(folder.write("t.glb", mirrored.glb()));
  EXPECT_FALSE(got.report.inverted);
  EXPECT_NEAR(got.report.signed_volume_m3, 1.0 / 6, 1e-15);
  EXPECT_EQ(got.report.min, Vec3(-1, 0, 0));
}

TEST(ImportFormats, ColladaUnitsBecomeMetres) {
  const Folder folder;
  Collada file;
  expect_tetrahedron(mesh::import_mesh(folder.write("m.dae", file.xml())));
  file.unit = R"(<unit name="millimeter" meter="0.001"/>)";
  expect_tetrahedron(mesh::import_mesh(folder.write("mm.dae", file.xml())), 0.001);
}

TEST(ImportFormats, ColladaAxesIgnoreTheUpAxis) {
  const Folder folder;
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    Collada file;
    file.up = up;
    expect_tetrahedron(mesh::import_mesh(folder.write("t.dae", file.xml())));
  }
}

TEST(ImportFormats, ColladaNodesAndTheirInstancesAreApplied) {
  const Folder folder;
  Collada file;
  file.library =
      R"(<library_nodes><node id="l"><scale>2 2 2</scale><instance_geometry url="#g"/></node></library_nodes>)";
  file.nodes = R"(<node id="n"><translate>1 2 3</translate><instance_node url="#l"/></node>)";
  expect_tetrahedron(mesh::import_mesh(folder.write("t.dae", file.xml())), 2.0, {1, 2, 3});
}

TEST(ImportFormats, IgnoresColladaMaterialsAndAnimations) {
  const Folder folder;
  Collada file;
  file.library =
      "<library_animations><animation><source id='x'><float_array id='x' "
      "count='9'>1</float_array></source>"
      "</animation></library_animations><library_controllers/><!-- a > b "
      "--><extra><technique>?</technique></extra>";
  expect_tetrahedron(mesh::import_mesh(folder.write("t.dae", file.xml())));
}

}  // namespace

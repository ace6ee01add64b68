/// Unusable files are refused with a sentence that names the file, the reason and the remedy;
/// nothing crashes.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/mesh/import.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "samples.hpp"
#include "tests/support/facts.hpp"

using namespace voxtouch;
using samples::Collada;
using samples::Folder;
using samples::Gltf;
using samples::tetrahedron;

namespace {

/// Some of these files crash assimp, hang it or fill memory.
const mesh::TriangleReader kApart = mesh_import::mesh_process({.cpu_s = 10, .memory_mib = 512});

class Refusal : public ::testing::Test {
 protected:
  /// The sentence of the refusal; it must name the file.
  std::string refusal(const std::filesystem::path& path, const mesh::ImportOptions& options = {}) {
    try {
      mesh::import_mesh(path, options, kApart);
    } catch (const mesh::MeshError& error) {
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("; "), std::string::npos)
          << "no remedy: " << error.what();
      return error.what();
    }
    ADD_FAILURE() << path << " was not refused";
    return {};
  }
  void expect_refused(const std::string& name, const std::string& bytes, const std::string& facts,
                      const mesh::ImportOptions& options = {}) {
    const std::string sentence = refusal(folder_.write(name, bytes), options);
    EXPECT_NE(sentence, "");
    EXPECT_EQ(test::missing_fact(sentence, facts), "") << sentence;
  }
  Folder folder_;
};

std::string ply(const std::string& vertices, const std::string& faces, const std::string& rows,
                const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + rows;
}

TEST_F(Refusal, NamesAMissingFile) {
  EXPECT_NE(refusal(folder_.path() / "none.obj").find("not found"), std::string::npos);
}

TEST_F(Refusal, NamesADirectory) {
  std::filesystem::create_directory(folder_.path() / "dir.obj");
  EXPECT_NE(refusal(folder_.path() / "dir.obj").find("directory"), std::string::npos);
}

TEST_F(Refusal, NamesAnIrregularFile) {
  std::filesystem::create_symlink("/dev/zero", folder_.path() / "zero.obj");
  EXPECT_NE(refusal(folder_.path() / "zero.obj").find("regular file"), std::string::npos);
}

TEST_F(Refusal, NamesAFileThatMayNotBeRead) {
  const auto path = folder_.write("secret.obj", samples::obj_text(tetrahedron()));
  std::filesystem::permissions(path, std::filesystem::perms::none);
  std::filesystem::permissions(
      folder_.path(), std::filesystem::perms::others_exec | std::filesystem::perms::group_exec,
      std::filesystem::perm_options::add);
  const uid_t me = geteuid();
  ASSERT_EQ(seteuid(me == 0 ? 65534 : me), 0);  // root may read everything: be none for this line
  const std::string text = refusal(path);
  ASSERT_EQ(seteuid(me), 0);
  EXPECT_NE(text.find("opened"), std::string::npos) << text;
}

TEST_F(Refusal, NamesTheSupportedFormats) {
  expect_refused("t.xyz", "1 2 3", "'xyz'|.obj|.stl|.ply|.gltf|.glb|.dae");
  expect_refused("t", "1 2 3", "''");
  expect_refused("t.blend", "BLENDER", "'blend'");
}

TEST_F(Refusal, OfFilesWithoutTriangles) {
  expect_refused("empty.obj", "", "is empty");
  expect_refused("vertices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "");
  expect_refused("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n",
                 "no triangles|0 points|2 lines");
  expect_refused("none.stl", std::string(84, '\0'), "");
  expect_refused("points.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                 "property float z\nend_header\n0 0 0\n",
                 "no triangles");
}

TEST_F(Refusal, OfNonFiniteVertices) {
  const std::string faces = "f 1 3 2\nf 1 2 4\n";
  for (const char* bad : {"nan", "inf", "-inf", "1e39"}) {
    expect_refused("t.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 ") + bad + "\n" + faces,
                   "vertex 5");
  }
}

TEST_F(Refusal, OfIndicesWithoutVertices) {
  expect_refused("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n", "");
  expect_refused("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -9 -2 -1\n", "");
  expect_refused("t.ply", ply("4", "1", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 77\n"), "1 corners");
  expect_refused("q.ply", ply("4", "1", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 777777777\n"),
                 "1 corners");
}

TEST_F(Refusal, OfAnAbsurdCountBeforeMemoryIsSpent) {
  rusage before{}, after{};
  ::getrusage(RUSAGE_SELF, &before);
  std::string stl(80, ' ');
  stl += samples::little({std::uint32_t{4'000'000'000}});
  expect_refused("huge.stl", stl, "4000000000 triangles|200000000084 bytes| 84");
  expect_refused("huge.ply", ply("1000000000000", "1", "0 0 0\n"), "1000000000000|'vertex'");
  expect_refused("huge_b.ply",
                 ply("3", "99999999999", std::string(60, '\0'), "binary_little_endian"),
                 "99999999999|'face'");
  expect_refused("more.ply", ply("99999999999999999999999", "1", "0 0 0\n"), "count");
  Gltf gltf;
  gltf.positions = R"({"bufferView":0,"componentType":5126,"count":4000000000,"type":"VEC3"})";
  expect_refused("huge.glb", gltf.glb(), "accessor 0|4000000000");
  Collada dae;
  dae.count = "4000000000";
  expect_refused("huge.dae", dae.xml(), "4000000000| 12");
  ::getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 64 * 1024) << "kilobytes";
}

TEST_F(Refusal, OfPlyColumnsThatAssimpMisreads) {
  const std::string whole = ply("4", "1", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  expect_refused("name.ply", with("float y", "float q"), "x, y or");
  expect_refused("type.ply", with("float y", "floaty y"), "'floaty'");
  expect_refused("line.ply", with("1.0\n", "1.0 "), "invalid line");
  expect_refused("format.ply", with("ascii", "askii"), "invalid line");
}

TEST_F(Refusal, OfMoreTrianglesOrBytesThanAllowed) {
  for (const char* name : {"t.obj", "t.stl", "t.ply", "t.glb", "t.dae"}) {
    const std::string e = std::filesystem::path(name).extension();
    const std::string bytes =
        e == ".obj"   ? samples::obj_text(tetrahedron())
        : e == ".stl" ? samples::binary_stl(tetrahedron())
        : e == ".glb" ? Gltf().glb()
        : e == ".dae"
            ? Collada().xml()
            : ply("4", "4", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    expect_refused(name, bytes, "4 triangles|limit 3", {.max_triangles = 3});
    expect_refused(name, bytes, "bytes|limit 40", {.max_file_bytes = 40});
  }
}

TEST_F(Refusal, OfTruncatedFiles) {
  const std::string binary = samples::binary_stl(tetrahedron()),
                    text = samples::text_stl(tetrahedron());
  expect_refused("cut.stl", binary.substr(0, binary.size() - 30), "truncated");
  expect_refused("header.stl", binary.substr(0, 60), "truncated");
  expect_refused("text.stl", text.substr(0, text.size() - 20), "truncated");
  expect_refused("inner.stl", text.substr(0, text.size() - 20) + "\nendsolid", "4 facets|3");
  std::string line = text;
  std::ranges::replace(line, '\n', ' ');
  expect_refused("one_line.stl", line, "line of 'solid'|line break");
  std::string first = text, second = text + text;
  first[first.find('\n')] = ' ';
  expect_refused("first_facet.stl", first, "line of 'solid'|line break");
  second.replace(second.find("endsolid"),
                 second.find("facet", text.size()) - second.find("endsolid"), "endsolid ");
  expect_refused("second_solid.stl", second, "line of 'solid'|line break");
  expect_refused("rows.ply", ply("4", "3", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1"),
                 "after 1");
  expect_refused("binary.ply",
                 ply("4", "2", std::string(48, '\0') + "\3" + std::string(12, '\0') + "\3",
                     "binary_little_endian"),
                 "after 1");
  const std::string glb = Gltf().glb(), dae = Collada().xml();
  for (const std::size_t left : {glb.size() - 20, std::size_t{40}, std::size_t{12}}) {
    expect_refused("cut.glb", glb.substr(0, left), "truncated");
  }
  expect_refused("cut.gltf", Gltf().json().substr(0, 100), "truncated");
  expect_refused("cut.dae", dae.substr(0, dae.size() * 3 / 4), "truncated");
  expect_refused("end.dae", dae.substr(0, dae.size() - 10), "truncated");
}

TEST_F(Refusal, OfIndicesThatAssimpWouldDropInSilence) {
  Gltf gltf;
  std::string bytes = gltf.glb();
  bytes.replace(bytes.size() - 2, 2, "\xff\xff");
  expect_refused("t.glb", bytes, "4 faces| 3");
}

TEST_F(Refusal, OfGltfThatWouldOverrunTheReader) {
  Gltf ring;
  ring.nodes = R"([{"mesh":0,"children":[1]},{"children":[0]}])";
  expect_refused("ring.glb", ring.glb(), "recursive reference");
  Gltf twice;
  twice.nodes = R"([{"children":[1,2]},{"children":[2]},{"mesh":0}])";
  expect_refused("twice.glb", twice.glb(), "two");
  expect_refused("deep.gltf", std::string(500000, '['), "JSON");
  Gltf strided;
  strided.positions =
      R"({"bufferView":0,"byteOffset":40,"componentType":5126,"count":4,"type":"VEC3"})";
  expect_refused("offset.glb", strided.glb(), "accessor 0|4 entries");
}

TEST_F(Refusal, OfColladaThatWouldOverrunTheReader) {
  Collada self;
  self.nodes = R"(<node id="n"><instance_geometry url="#g"/><instance_node url="#n"/></node>)";
  expect_refused("self.dae", self.xml(), "reader");
  Collada ring;
  ring.library =
      R"(<library_nodes><node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node></library_nodes>)";
  ring.nodes = R"(<node id="n"><instance_node url="#a"/></node>)";
  expect_refused("ring.dae", ring.xml(), "reader");
  Collada deep;
  for (int k = 0; k < 20000; ++k)
    deep.nodes += "<node>";
  for (int k = 0; k < 20000; ++k)
    deep.nodes += "</node>";
  expect_refused("deep.dae", deep.xml(), "reader");
  Collada bomb;
  bomb.library = "<library_nodes><node id=\"n0\"><instance_geometry url=\"#g\"/></node>";
  for (int k = 1; k < 30; ++k) {
    const std::string inner =
        std::string("<instance_node url=\"#n").append(std::to_string(k - 1)).append("\"/>");
    bomb.library.append("<node id=\"n")
        .append(std::to_string(k))
        .append("\">")
        .append(inner)
        .append(inner)
        .append("</node>");
  }
  bomb.library += "</library_nodes>";
  bomb.nodes = R"(<node id="n"><instance_node url="#n29"/></node>)";
  expect_refused("bomb.dae", bomb.xml(), "memory");
  Collada few;
  few.count = "11";
  expect_refused("few.dae", few.xml(), "11 numbers| 12");
  Collada wide;
  wide.stride = "30";
  expect_refused("wide.dae", wide.xml(), "12 numbers");
  Collada word;
  word.p = "0 2$1 0 1 3 0 3 2 1 2 3";
  expect_refused("word.dae", word.xml(), "number");
  word.p = "0 2 \v 1 0 1 3 0 3 2 1 2 3";
  expect_refused("tab.dae", word.xml(), "memory");
  Collada corners;
  corners.kind = "polylist", corners.faces = "2",
  corners.p = "0 2 1</p><vcount>3 2000000000</vcount><p>0";
  expect_refused("corners.dae", corners.xml(), "reader");
  Collada missing;
  missing.nodes =
      R"(<node id="n"><instance_geometry url="#g"/><instance_node url="#gone"/></node>)";
  expect_refused("missing.dae", missing.xml(), "'gone'");
}

TEST_F(Refusal, OfFilesThatTripAssimpsAssertions) {
  Collada contradiction;
  contradiction.kind = "polygons", contradiction.faces = "5";  // and one <p>, which is one polygon
  expect_refused("t.dae", contradiction.xml(), "Aborted");
}

TEST_F(Refusal, OfCoordinatesTooLargeForTheirVoxels) {
  mesh::TriangleMesh far = tetrahedron();
  for (Vec3& v : far.vertices)
    v.x() += 1e6;
  const std::string text = samples::obj_text(far);
  expect_refused("far.obj", text, "0.0625 m|0.001 m|1e-05 m", {.voxel_size_m = 0.001});
  EXPECT_NO_THROW(mesh::import_mesh(folder_.write("far.obj", text)));
  EXPECT_NO_THROW(mesh::import_mesh(folder_.write("far.obj", text), {.voxel_size_m = 10}));
  EXPECT_NO_THROW(
      mesh::import_mesh(folder_.write("far.obj", text), {.scale = 1e-9, .voxel_size_m = 1e-8}));
  const auto near = folder_.write("near.obj", samples::obj_text(tetrahedron()));
  EXPECT_NO_THROW(
      mesh::import_mesh(near, {.pose = {{1e6, 0, 0}, Quat::Identity()}, .voxel_size_m = 0.001}));
  Gltf node;
  node.nodes = R"([{"mesh":0,"translation":[1000000,0,0]}])";
  expect_refused("node.glb", node.glb(), "0.0625 m", {.voxel_size_m = 0.001});
}

TEST_F(Refusal, OfInvalidOptions) {
  const std::string text = samples::obj_text(tetrahedron());
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    expect_refused("t.obj", text, "scale", {.scale = scale});
  }
  for (const double voxel : {-1.0, std::nan(""), HUGE_VAL}) {
    expect_refused("t.obj", text, "voxel size", {.voxel_size_m = voxel});
  }
  expect_refused("t.obj", text, "pose", {.pose = {Vec3::Zero(), Quat(0, 0, 0, 0)}});
  expect_refused("t.obj", text, "pose", {.pose = {Vec3(std::nan(""), 0, 0), Quat::Identity()}});
}

/// Fixed seed: the same few thousand damaged files on every run. Read or refused, and nothing else.
TEST_F(Refusal, OrAMeshResultsFromEveryDamagedFile) {
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::vector<std::pair<std::string, std::string>> seeds = {
      {"f.obj", samples::obj_text(tetrahedron()) + "l 1 2\ng a\nf 1 2 3 4\n"},
      {"f.stl", samples::text_stl(tetrahedron())},
      {"g.stl", samples::binary_stl(tetrahedron())},
      {"f.ply", ply("4", "4", rows)},
      {"f.glb", Gltf().glb()},
      {"f.dae", Collada().xml()}};
  const std::array<const char*, 8> words = {"-1", "4294967295", "nan", "1e39",
                                            "\n", "<",          "\"",  "["};
  constexpr unsigned kSeed = 20010;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 1200; ++round) {
    auto [name, bytes] = seeds[static_cast<std::size_t>(round) % seeds.size()];
    for (unsigned k = random() % 4 + 1; k > 0 && !bytes.empty(); --k) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 5) {
        case 0:
          bytes[at] = static_cast<char>(random());
          break;
        case 1:
          bytes.erase(at, random() % 16 + 1);
          break;
        case 2:
          bytes.insert(at, words[random() % words.size()]);
          break;
        case 3:
          bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 40));
          break;
        default:
          if (random() % 8 == 0)
            bytes.resize(at);
      }
    }
    try {
      const mesh::ImportedMesh got = mesh::import_mesh(
          folder_.write(std::to_string(round) + name, bytes), {.max_triangles = 10000}, kApart);
      EXPECT_FALSE(got.mesh.empty());
      EXPECT_EQ(got.report.not_finite_vertices.count, 0u);
    } catch (const mesh::MeshError&) {
    }
  }
}

}  // namespace

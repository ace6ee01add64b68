// Mesh files of every format, through the checks and assimp in a separate process, and the
// following steps; and possible answers of such a process. First byte: the format, or an answer;
// second: options.
#include <algorithm>
#include <array>

#include "nodes/mesh_import/answer.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

constexpr std::array kEndings = {"obj", "stl", "ply", "gltf", "glb", "dae"};
constexpr std::size_t kMaxTriangles = 5000;

void check(const mesh::ImportedMesh& read) {
  const mesh::TriangleMesh& mesh = read.mesh;
  FUZZ_REQUIRE(!mesh.triangles.empty() && mesh.triangles.size() <= kMaxTriangles);
  for (const Vec3& v : mesh.vertices)
    FUZZ_REQUIRE(v.allFinite());
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      FUZZ_REQUIRE(corner < mesh.vertices.size());
  FUZZ_REQUIRE(read.report.triangles == mesh.triangles.size() &&
               read.report.vertices == mesh.vertices.size());
  FUZZ_REQUIRE(read.report.not_finite_vertices.count == 0);
  for (const std::string& sentence : read.report.sentences())
    FUZZ_REQUIRE(!sentence.empty());
}

void check_answer(std::string_view bytes) {
  try {
    const mesh::FileTriangles read = mesh_import::decode(bytes);
    FUZZ_REQUIRE(mesh_import::decode(mesh_import::encode(read)).mesh.triangles ==
                 read.mesh.triangles);
    for (const Vec3& v : read.mesh.vertices)
      FUZZ_REQUIRE(v.allFinite());
    for (const auto& t : read.mesh.triangles)
      FUZZ_REQUIRE(std::max({t[0], t[1], t[2]}) < read.mesh.vertices.size());
  } catch (const std::runtime_error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Folder folder;
  fuzz::Bytes in(data, size);
  const std::size_t format = in.take<std::uint8_t>() % (kEndings.size() + 1);
  const auto choice = in.take<std::uint8_t>();
  if (format == kEndings.size())
    return check_answer(in.rest()), 0;
  mesh::ImportOptions options;
  options.max_triangles = kMaxTriangles;
  options.max_file_bytes = 1 << 16;
  if (choice & 1)
    options.scale = 0.001;
  if (choice & 2)
    options.voxel_size_m = 0.002;
  if (choice & 4)
    options.pose = {Vec3(0.1, -0.2, 0.3), Quat(0.5, 0.5, -0.5, 0.5)};
  const std::filesystem::path file =
      folder.write(std::string("mesh.") + kEndings[format], in.rest());
  try {
    check(mesh::import_mesh(file, options, mesh_import::mesh_process({.cpu_s = 5})));
  } catch (const mesh::MeshError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with("mesh '"));
  }
  return 0;
}

// Mesh files of every format, through the checks, assimp and what is made of its result. First byte: the format; second: options.
#include <array>

#include "core/mesh/import.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

constexpr std::array kEndings = {"obj", "stl", "ply", "gltf", "glb", "dae"};
constexpr std::size_t kMaxTriangles = 5000;

void check(const ImportedMesh& read) {
  const TriangleMesh& mesh = read.mesh;
  FUZZ_REQUIRE(!mesh.triangles.empty() && mesh.triangles.size() <= kMaxTriangles);
  for (const Vec3& v : mesh.vertices) FUZZ_REQUIRE(v.allFinite());
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) FUZZ_REQUIRE(corner < mesh.vertices.size());
  FUZZ_REQUIRE(read.report.triangles == mesh.triangles.size() && read.report.vertices == mesh.vertices.size());
  FUZZ_REQUIRE(read.report.not_finite_vertices.count == 0);
  for (const std::string& sentence : read.report.sentences()) FUZZ_REQUIRE(!sentence.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Folder folder;
  fuzz::Bytes in(data, size);
  const char* ending = kEndings[in.take<std::uint8_t>() % kEndings.size()];
  const auto choice = in.take<std::uint8_t>();
  ImportOptions options;
  options.max_triangles = kMaxTriangles;
  options.max_file_bytes = 1 << 16;
  if (choice & 1) options.scale = 0.001;
  if (choice & 2) options.voxel_size_m = 0.002;
  if (choice & 4) options.pose = {Vec3(0.1, -0.2, 0.3), Quat(0.5, 0.5, -0.5, 0.5)};
  const std::filesystem::path file = folder.write(std::string("mesh.") + ending, in.rest());
  try {
    check(import_mesh(file, options));
  } catch (const MeshError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with("mesh '"));
  }
  return 0;
}

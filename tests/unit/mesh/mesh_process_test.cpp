/// Reading in a separate process: the same result, and a sentence for every failure.
#include "nodes/mesh_import/mesh_process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <limits>
#include <thread>

#include "nodes/mesh_import/answer.hpp"
#include "samples.hpp"

using namespace voxtouch;
using samples::Folder;

namespace {

/// Node n instances node n - 1 twice: 2^29 instances in total.
std::string endless() {
  samples::Collada bomb;
  bomb.library = "<library_nodes><node id=\"n0\"><instance_geometry url=\"#g\"/></node>";
  for (int k = 1; k < 30; ++k) {
    const std::string inner = "<instance_node url=\"#n" + std::to_string(k - 1) + "\"/>";
    bomb.library += "<node id=\"n" + std::to_string(k) + "\">" + inner + inner + "</node>";
  }
  bomb.library += "</library_nodes>";
  bomb.nodes = R"(<node id="n"><instance_node url="#n29"/></node>)";
  return bomb.xml();
}

std::string sentence(const std::filesystem::path& path, const mesh_import::ReadLimits& limits) {
  try {
    mesh::import_mesh(path, {}, mesh_import::mesh_process(limits));
  } catch (const mesh::MeshError& refusal) {
    return refusal.what();
  }
  return "read";
}

TEST(MeshProcess, EqualsReadingInProcess) {
  const Folder folder;
  for (const std::filesystem::path& path :
       {std::filesystem::path(VOXTOUCH_DEPLOY "/meshes/cup.obj"),
        folder.write("t.glb", samples::Gltf().glb()),
        folder.write("t.dae", "\xef\xbb\xbf" + samples::Collada().xml()),
        folder.write("l.obj", samples::obj_text(samples::tetrahedron()) + "l 1 2\n")}) {
    const mesh::ImportedMesh here = mesh::import_mesh(path, {.voxel_size_m = 0.002});
    const mesh::ImportedMesh apart =
        mesh::import_mesh(path, {.voxel_size_m = 0.002}, mesh_import::mesh_process());
    EXPECT_EQ(here.mesh.vertices, apart.mesh.vertices);
    EXPECT_EQ(here.mesh.triangles, apart.mesh.triangles);
    EXPECT_EQ(here.warnings, apart.warnings);
  }
}

TEST(MeshProcess, ReadsInManyThreadsAtOnce) {
  std::vector<std::jthread> threads;
  for (int n = 0; n < 6; ++n) {
    threads.emplace_back([] {
      EXPECT_FALSE(
          mesh::import_mesh(VOXTOUCH_DEPLOY "/meshes/cup.obj", {}, mesh_import::mesh_process())
              .mesh.empty());
    });
  }
}

TEST(MeshProcess, RefusesTooMuchTimeOrMemory) {
  const Folder folder;
  const auto bomb = folder.write("bomb.dae", endless());
  const std::string slow = sentence(bomb, {.cpu_s = 1});
  EXPECT_NE(slow.find(" 1 s;"), std::string::npos) << slow;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const std::string large = sentence(bomb, {.cpu_s = 20, .memory_mib = 256});
  EXPECT_NE(large.find("memory"), std::string::npos) << large;
#endif
}

/// The child of `parent`, or 0.
pid_t child_of(pid_t parent) {
  const std::string pid = std::to_string(parent);
  pid_t child = 0;
  std::ifstream("/proc/" + pid + "/task/" + pid + "/children") >> child;
  return child;
}

template <class Condition>
bool soon(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

TEST(MeshProcess, EndsWithItsCallerAndInheritsNoFiles) {
  const Folder folder;
  const auto bomb = folder.write("bomb.dae", endless());
  const int inherited_file = ::open("/dev/null", O_RDONLY);  // not closed on exec
  const pid_t asks = ::fork();
  if (asks == 0) {
    sentence(bomb, {.cpu_s = 60});
    ::_exit(0);
  }
  ASSERT_TRUE(soon([&] { return child_of(asks) > 0; }));
  const std::filesystem::path reader = "/proc/" + std::to_string(child_of(asks));
  EXPECT_TRUE(soon([&] {
    std::error_code error;
    return std::filesystem::read_symlink(reader / "exe", error).filename() ==
           "voxtouch_import_mesh";
  }));
  EXPECT_TRUE(soon([&] {  // not at once: libraries are files, too
    int last = 0;
    for (const auto& file : std::filesystem::directory_iterator(reader / "fd")) {
      last = std::max(last, std::stoi(file.path().filename()));
    }
    return last == mesh_import::kSharedFile;
  }));
  ::kill(asks, SIGKILL);
  ::waitpid(asks, nullptr, 0);
  EXPECT_TRUE(soon([&] { return !std::filesystem::exists(reader); }));
  ::close(inherited_file);
}

TEST(MeshProcess, DryRunsUncheckedReaders) {
  const Folder folder;
  samples::Collada self;
  self.nodes = R"(<node id="n"><instance_geometry url="#g"/><instance_node url="#n"/></node>)";
  scene::Scene scene;
  scene.dynamic_mesh.path = folder.write("good.dae", samples::Collada().xml());
  EXPECT_NO_THROW(mesh_import::dry_run_reading(scene));
  scene.static_meshes.resize(1);
  scene.static_meshes[0].path = folder.write("self.dae", self.xml());
  EXPECT_THROW(mesh_import::dry_run_reading(scene), mesh::MeshError);
  scene.static_meshes[0].path = folder.write("none.dae", "no XML");
  EXPECT_NO_THROW(mesh_import::dry_run_reading(scene));
}

TEST(MeshProcess, RefusesInconsistentReplies) {
  const mesh::FileTriangles read{.mesh = samples::tetrahedron(),
                                 .points = 1,
                                 .lines = 2,
                                 .spacing = 4,
                                 .largest = 5,
                                 .warnings = {"a", "b"}};
  const std::string answer = mesh_import::encode(read);
  const mesh::FileTriangles back = mesh_import::decode(answer);
  EXPECT_EQ(back.mesh.vertices, read.mesh.vertices);
  EXPECT_EQ(back.mesh.triangles, read.mesh.triangles);
  EXPECT_EQ(back.warnings, read.warnings);
  EXPECT_EQ(back.points + 10 * back.lines, 21u);
  EXPECT_EQ(back.spacing + 10 * back.largest, 54.0);
  for (std::size_t size = 0; size < answer.size(); ++size)
    EXPECT_THROW(mesh_import::decode(answer.substr(0, size)), std::runtime_error);
  for (std::size_t field = 0; field < 5; ++field) {
    std::string wrong = answer;
    wrong[8 * field + 7] = '\x20';
    EXPECT_THROW(mesh_import::decode(wrong), std::runtime_error) << field;
  }
  mesh::FileTriangles bad = read;
  bad.mesh.triangles[2][1] = 4;
  EXPECT_THROW(mesh_import::decode(mesh_import::encode(bad)), std::runtime_error);
  bad = read;
  bad.mesh.vertices[3].z() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(mesh_import::decode(mesh_import::encode(bad)), std::runtime_error);
  EXPECT_THROW(mesh_import::decode(mesh_import::encode_refusal("no")), mesh::MeshError);
}

}  // namespace

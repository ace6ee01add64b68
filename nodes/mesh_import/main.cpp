/// voxtouch_import_mesh PATH MAX_TRIANGLES CPU_S MEMORY_MIB PARENT HOW: started by mesh_process().
/// The mesh's bytes are in kSharedFile, and the answer replaces them.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "core/mesh/weld.hpp"
#include "core/types/version.hpp"
#include "nodes/mesh_import/answer.hpp"

namespace {

void limit(decltype(RLIMIT_CPU) what, std::uint64_t most, std::uint64_t grace = 0) {
  const rlimit both{most, most + grace};
  ::setrlimit(what, &both);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && argv[1] == std::string_view("--version"))
    return std::puts(std::string(voxtouch::version()).c_str()) < 0 ? 1 : 0;
  const auto number = [argv](int n) { return std::strtoull(argv[n], nullptr, 10); };
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (argc != 7 || static_cast<unsigned long long>(::getppid()) != number(5))
    return 2;  // the parent ended earlier
  limit(RLIMIT_CPU, number(3), 1);
  limit(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(VOXTOUCH_SANITIZED)
  limit(RLIMIT_AS, number(4) << 20);
#endif
  ::alarm(static_cast<unsigned>(3 * number(3)));
  voxtouch::mesh::ImportOptions options;
  options.max_triangles = number(2);
  const std::string shared = "/proc/self/fd/" + std::to_string(voxtouch::mesh_import::kSharedFile);
  std::string answer;
  try {
    if (argv[6] == std::string_view(voxtouch::mesh_import::kAsItIs)) {
      Assimp::Importer().ReadFile(argv[1], 0);
      answer = voxtouch::mesh_import::encode({});
    } else {
      voxtouch::mesh::FileTriangles read =
          voxtouch::mesh::read_triangles(argv[1], voxtouch::mesh::read_mesh_bytes(shared), options);
      // An STL has each vertex about six times. The receiver welds too, with an equal result.
      read.mesh = voxtouch::mesh::weld(read.mesh, 0.0);
      answer = voxtouch::mesh_import::encode(read);
    }
  } catch (const voxtouch::mesh::MeshError& refusal) {
    answer = voxtouch::mesh_import::encode_refusal(refusal.what());
  }
  return std::ofstream(shared, std::ios::binary) << answer << std::flush ? 0 : 1;
}

#include "nodes/mesh_import/mesh_process.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sched.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/types/program_folder.hpp"
#include "nodes/mesh_import/answer.hpp"

extern char** environ;

namespace voxtouch::mesh_import {
namespace {

/// vfork and exec in one: safe while other threads run. Throws std::runtime_error.
pid_t spawn(const std::vector<std::string>& words, int shared) {
  std::vector<char*> argv;
  for (const std::string& word : words)
    argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  // assimp clears 16 MB for each OBJ file: in large pages that takes 1 ms, in small ones 10.
  std::string large_pages = "GLIBC_TUNABLES=glibc.malloc.hugetlb=1";
  std::vector<char*> environment{large_pages.data()};
  for (char** variable = environ; *variable != nullptr; ++variable)
    environment.push_back(*variable);
  environment.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, shared,
                                   kSharedFile);  // first: it may have one of the numbers below
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, kSharedFile + 1);
  // A new process group: Ctrl-C belongs to this program. No blocked signal, because limits arrive
  // as signals. Not the real-time priority of the caller.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  const sched_param ordinary{};
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setschedpolicy(&attributes, SCHED_OTHER);
  posix_spawnattr_setschedparam(&attributes, &ordinary);
  posix_spawnattr_setflags(
      &attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSCHEDULER);
  pid_t child = 0;
  const int error =
      ::posix_spawn(&child, argv[0], &files, &attributes, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0)
    throw std::runtime_error(fmt::format("cannot start {}: {}", words[0], std::strerror(error)));
  return child;
}

mesh::FileTriangles read_apart(const std::filesystem::path& path, const std::string& bytes,
                               const mesh::ImportOptions& options, const ReadLimits& limits,
                               const std::string& how) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> shared(
      ::fdopen(::memfd_create("mesh", MFD_CLOEXEC), "r+"), ::fclose);
  if (!shared || std::fwrite(bytes.data(), 1, bytes.size(), shared.get()) != bytes.size() ||
      std::fflush(shared.get()) != 0) {
    throw std::runtime_error(
        fmt::format("cannot allocate shared memory: {}", std::strerror(errno)));
  }
  const std::filesystem::path program =
      limits.program.empty() ? program_folder() / "voxtouch_import_mesh" : limits.program;
  const pid_t child =
      spawn({program, path, std::to_string(options.max_triangles), std::to_string(limits.cpu_s),
             std::to_string(limits.memory_mib), std::to_string(::getpid()), how},
            ::fileno(shared.get()));
  int status = 127 << 8;  // unknown exit status
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR)
    continue;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGALRM) {
    mesh::import::refuse(path, fmt::format("reading exceeded the limit of {} s", limits.cpu_s),
                         "reduce the mesh, or export it again");
  }
  if (signal != 0) {
    mesh::import::refuse(path, fmt::format("the reader process crashed ({})", ::strsignal(signal)),
                         "the file is damaged: export it again");
  }
  if (status != 0)
    throw std::runtime_error(
        fmt::format("the reader process ended with status {}", WEXITSTATUS(status)));
  return decode(mesh::read_mesh_bytes(fmt::format("/proc/self/fd/{}", ::fileno(shared.get())),
                                      ~std::uintmax_t{0}));
}

/// The same with every reason in a sentence.
mesh::FileTriangles read_or_refuse(const std::filesystem::path& path, const std::string& bytes,
                                   const mesh::ImportOptions& options, const ReadLimits& limits,
                                   const std::string& how) {
  try {
    return read_apart(path, bytes, options, limits, how);
  } catch (const mesh::MeshError&) {
    throw;
  } catch (const std::exception& error) {
    mesh::import::refuse(path, fmt::format("cannot be read: {}", error.what()),
                         "check that voxtouch_import_mesh is in the same folder as this program");
  }
}

}  // namespace

mesh::TriangleReader mesh_process(const ReadLimits& limits) {
  return [limits](const std::filesystem::path& path, const std::string& bytes,
                  const mesh::ImportOptions& options) {
    return read_or_refuse(path, bytes, options, limits, "checked");
  };
}

void dry_run_reading(const scene::Scene& scene) {
  for (const scene::MeshSpec& mesh : scene.static_meshes)
    read_or_refuse(mesh.path, {}, {}, {}, kAsItIs);
  read_or_refuse(scene.dynamic_mesh.path, {}, {}, {}, kAsItIs);
}

}  // namespace voxtouch::mesh_import

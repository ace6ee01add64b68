#pragma once
/// One arbitrary mesh file: read, converted to voxels and shell, touched; in a separate process, so
/// that any failure is observed.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace voxtouch::hostile {

/// Result of a file. Only the first two are acceptable.
enum class Outcome {
  kTouched,    ///< finite, bounded answers at every pose
  kRefused,    ///< with a sentence
  kNotFinite,  ///< a NaN, an infinity or a force beyond its bound
  kNoContact,  ///< built, but no pose met it
  kUnnamed,    ///< refused without a sentence that names the file or the reason
  kOutOfTime,  ///< its CPU time or its time on the clock ran out
  kCrashed,    ///< ended by a signal, or without a word
};
std::string name_of(Outcome outcome);

/// Limits for a file, and how it is touched.
struct Limits {
  unsigned cpu_s = 20;  ///< RLIMIT_CPU; the clock may show ten times as much
  std::uint64_t memory_mib =
      4096;  ///< RLIMIT_AS; not set for a sanitizer, which needs the address space
  std::uint32_t poses = 1000;  ///< of a ball on the mesh, and as many of the mesh on a block
  std::uint64_t seed = 1;
};

struct Verdict {
  std::filesystem::path file;
  Outcome outcome = Outcome::kCrashed;
  std::string sentence;  ///< of the refusal, or the fault; for a touched file the findings
  double cpu_s = 0.0;    ///< that the process took
  std::uint64_t peak_mib = 0;
  bool good() const { return outcome == Outcome::kTouched || outcome == Outcome::kRefused; }
};

/// Reads `file`, takes a fortieth of its longest side for the voxel, and touches it with every
/// contact model: a ball of three voxels against the mesh, then the mesh as the tool against a
/// block. Runs here; `attempt` wraps it.
Verdict touch(const std::filesystem::path& file, const Limits& limits);

/// `touch` in a forked process under the limits. The caller must have no other threads.
Verdict attempt(const std::filesystem::path& file, const Limits& limits);

/// All regular files below `folder`, sorted by path.
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder);

/// Counts by format and outcome, and every refusal's reason with its files: Markdown.
std::string as_markdown(const std::vector<Verdict>& verdicts);
/// One row a file.
std::string as_csv(const std::vector<Verdict>& verdicts);

}  // namespace voxtouch::hostile

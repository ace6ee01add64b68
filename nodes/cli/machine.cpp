#include "nodes/cli/machine.hpp"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

#include "core/types/version.hpp"

namespace voxtouch::cli {
namespace {

/// "model name" on x86, "Model" or "Hardware" on others.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon + 2 >= line.size())
      continue;
    if (line.starts_with("model name") || line.starts_with("Model\t") ||
        line.starts_with("Hardware"))
      return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine this_machine() {
#if defined(__clang__)
  const std::string compiler = "clang " __clang_version__;
#else
  const std::string compiler = "gcc " __VERSION__;
#endif
  return {.version = std::string(version()),
          .processor = processor_name(),
          .cpus = std::thread::hardware_concurrency(),
          .compiler = compiler,
          .flags = VOXTOUCH_CXX_FLAGS};
}

double load_average() {
  double one_minute = 0.0;
  return ::getloadavg(&one_minute, 1) == 1 ? one_minute : -1.0;
}

double thread_cpu_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace voxtouch::cli

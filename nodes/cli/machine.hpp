#pragma once
/// The machine on which times were measured.
#include <string>

namespace voxtouch::cli {

struct Machine {
  std::string version;    ///< of voxtouch
  std::string processor;  ///< as the system reports it, or "unknown"
  unsigned cpus = 0;      ///< that the system has online
  std::string compiler, flags;
};

/// Reads /proc/cpuinfo; never throws.
Machine this_machine();
/// Load average over the last minute; negative if unknown.
double load_average();
/// Processor time of the calling thread [s], independent of the machine's load.
double thread_cpu_s();

}  // namespace voxtouch::cli

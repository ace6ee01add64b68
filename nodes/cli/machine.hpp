#pragma once
/// Under what conditions times were measured: without them a number of microseconds says nothing.
#include <string>

namespace voxtouch::cli {

struct Machine {
  std::string version;    ///< of voxtouch
  std::string processor;  ///< as the system names it; "unknown" where it does not
  unsigned cpus = 0;      ///< that the system has online
  std::string compiler, flags;
};

/// Reads /proc/cpuinfo; never throws for what it does not find.
Machine this_machine();
/// Load average over the last minute; negative where the system does not say.
double load_average();
/// Processor time of the calling thread so far [s]: what a frame costs, whatever else the machine
/// does.
double thread_cpu_s();

}  // namespace voxtouch::cli

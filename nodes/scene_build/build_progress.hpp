#pragma once
/// Shows how far a build is, and how long the rest may take.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>

#include "core/types/parallel.hpp"

namespace voxtouch::scene_build {

/// A step of a build, which has any number of loops one after another.
struct StepSoFar {
  std::string name;
  double for_s = 0.0;               ///< since it began
  std::size_t loop = 0;             ///< which of its loops runs, from 1 on; 0: none
  double loop_s = 0.0;              ///< since that one began
  std::size_t done = 0, count = 0;  ///< bodies of that loop
};

/// "distance field, loop 2: 40 %, about 6 s more"; without a loop "reading the static meshes: 3 s
/// so far".
std::string in_words(const StepSoFar& step);

/// Prints "<who>: <step>" on a terminal once a second, and nothing in the first second, from a
/// separate thread, so that a step without an end is visible. Has the progress callback and the
/// loops of one build.
class BuildProgress {
 public:
  explicit BuildProgress(std::string label);
  ~BuildProgress();
  BuildProgress(const BuildProgress&) = delete;
  BuildProgress& operator=(const BuildProgress&) = delete;

  /// The step before has ended.
  void begin_step(const std::string& name);
  /// `loop` with its bodies counted. The builder runs one loop at a time.
  ParallelFor counted(ParallelFor loop);
  StepSoFar so_far() const;

 private:
  using Clock = std::chrono::steady_clock;
  void print_progress();

  const std::string label_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  StepSoFar step_;  ///< but for the times
  Clock::time_point step_begin_ = Clock::now(), loop_begin_ = step_begin_;
  std::atomic<std::size_t> done_{0};
  std::jthread thread_;  ///< last: it sees all others
};

}  // namespace voxtouch::scene_build

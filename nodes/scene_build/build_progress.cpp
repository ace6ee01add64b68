#include "nodes/scene_build/build_progress.hpp"

#include <cmath>

#include <fmt/format.h>

#include "nodes/console/log.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::scene_build {

std::string in_words(const StepSoFar& step) {
  // Behind a loop there may be work that is no loop.
  if (step.loop == 0 || step.done == 0 || step.done >= step.count)
    return fmt::format("{}: {:.0f} s elapsed", step.name, step.for_s);
  const double fraction = static_cast<double>(step.done) / static_cast<double>(step.count);
  return fmt::format("{}, loop {}: {:.0f} %, about {:.0f} s remain", step.name, step.loop,
                     std::floor(100.0 * fraction),
                     std::ceil(step.loop_s * (1.0 - fraction) / fraction));
}

BuildProgress::BuildProgress(std::string label) : label_(std::move(label)) {
  if (console::stderr_is_terminal())
    thread_ = std::jthread([this] { print_progress(); });
}

BuildProgress::~BuildProgress() {
  const std::lock_guard lock(mutex_);
  over_ = true;
  ended_.notify_all();
}

void BuildProgress::begin_step(const std::string& name) {
  const std::lock_guard lock(mutex_);
  step_ = {.name = name};
  step_begin_ = Clock::now();
}

ParallelFor BuildProgress::counted(ParallelFor loop) {
  return [this, loop = std::move(loop)](std::size_t count,
                                        const std::function<void(std::size_t)>& body) {
    {
      const std::lock_guard lock(mutex_);
      ++step_.loop, step_.count = count;
      done_ = 0;
      loop_begin_ = Clock::now();
    }
    loop(count, [&](std::size_t i) {
      body(i);
      done_.fetch_add(1, std::memory_order_relaxed);
    });
  };
}

StepSoFar BuildProgress::so_far() const {
  const std::lock_guard lock(mutex_);
  const auto seconds = [now = Clock::now()](Clock::time_point since) {
    return std::chrono::duration<double>(now - since).count();
  };
  StepSoFar step = step_;
  step.for_s = seconds(step_begin_), step.loop_s = seconds(loop_begin_), step.done = done_;
  return step;
}

void BuildProgress::print_progress() {
  runtime::ordinary_priority();
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, std::chrono::seconds(1), [this] { return over_; })) {
    lock.unlock();
    if (const StepSoFar step = so_far(); !step.name.empty())
      console::show_progress("{}: {}", label_, in_words(step));
    lock.lock();
  }
}

}  // namespace voxtouch::scene_build

#include "nodes/view/changer.hpp"

#include <exception>
#include <utility>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::view {

Changer::Changer(const bus::Participant& participant, const runtime::NodeOptions& options,
                 std::function<void(const std::vector<std::string>&, const std::string&)> told)
    : asker_(participant, options), told_(std::move(told)), thread_([this] { run(); }) {}

Changer::~Changer() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  something_.notify_one();
  thread_.join();
}

bool Changer::change(std::vector<std::string> words) {
  constexpr std::size_t kMost = 8;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMost) return false;
  waiting_.push_back(std::move(words));
  something_.notify_one();
  return true;
}

void Changer::run() {
  runtime::ordinary_priority();
  const auto leaving = [this] {
    const std::lock_guard lock(mutex_);
    return stop_;
  };
  std::unique_lock lock(mutex_);
  for (;;) {
    something_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (stop_) return;
    const std::vector<std::string> words = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    std::string problem;
    try {
      runtime::ChangeWords asked;
      asked.words = words;
      problem = asker_.ask(asked, [](const auto&) {}, [](const auto&) {}, leaving);
    } catch (const std::exception& error) {
      problem = error.what();
    }
    told_(words, problem);
    lock.lock();
  }
}

}  // namespace voxtouch::view

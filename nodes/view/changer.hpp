#pragma once
/// Sends what the page wants changed, in a thread of its own: an answer may take its time.
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "nodes/runtime/change_asker.hpp"

namespace voxtouch::view {

class Changer {
 public:
  /// `told` is called from that thread with the words and the sentence of what was not done; empty: it was.
  Changer(const bus::Participant& participant, const runtime::NodeOptions& options,
          std::function<void(const std::vector<std::string>&, const std::string&)> told);
  ~Changer();
  Changer(const Changer&) = delete;
  Changer& operator=(const Changer&) = delete;

  /// False where too many are waiting.
  bool change(std::vector<std::string> words);

 private:
  void run();
  runtime::ChangeAsker asker_;
  std::function<void(const std::vector<std::string>&, const std::string&)> told_;
  std::mutex mutex_;
  std::condition_variable something_;
  std::deque<std::vector<std::string>> waiting_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace voxtouch::view

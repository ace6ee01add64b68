#pragma once
/// A bare DDS reader that is woken in one of three ways, to compare them and to measure the ring's
/// overhead.
#include <semaphore.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::test {

/// By a wait set; by a listener that wakes the thread; by a listener that answers in the thread of
/// DDS that received.
inline const std::vector<std::string>& wake_methods() {
  static const std::vector<std::string> methods = {"waitset", "listener_wakes", "listener_answers"};
  return methods;
}

/// A reader of a stream that calls `answer` for each sample.
template <class T>
class Woken {
 public:
  using Answer = std::function<void(const T&)>;
  Woken(const bus::Participant& participant, const qos::Topic& row, std::string_view rig,
        const std::string& method, Answer answer)
      : reader_(participant, row, rig, qos::profile(qos::ProfileId::kStream)),
        answer_(std::move(answer)),
        answers_in_listener_(method == wake_methods()[2]) {
    sem_init(&waiting_, 0, 0);
    if (method == wake_methods()[0]) {
      wait_set_.emplace(participant);
      wait_set_->attach(reader_.condition());
      return;
    }
    dds_listener_t* listener = dds_create_listener(this);
    dds_lset_data_available(listener,
                            [](dds_entity_t, void* self) { static_cast<Woken*>(self)->on_data(); });
    dds_set_listener(reader_.get(), listener);
    dds_delete_listener(listener);
  }
  ~Woken() { dds_set_listener(reader_.get(), nullptr); }
  Woken(const Woken&) = delete;
  Woken& operator=(const Woken&) = delete;

  /// Answers received samples, until `end_ns` of the monotonic clock or until `done` returns true,
  /// which is called after each sample and 20 times a second.
  void run_until(
      std::int64_t end_ns, const std::function<bool()>& done = [] { return false; }) {
    for (std::int64_t left; (left = end_ns - runtime::monotonic_ns()) > 0 && !done();) {
      const std::int64_t ns = std::min<std::int64_t>(left, 50'000'000);
      if (wait_set_) {
        wait_set_->wait(ns);
        take();
      } else if (answers_in_listener_) {
        runtime::sleep_until(runtime::monotonic_ns() + ns);
      } else {
        timespec until{};
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += ns;
        until.tv_sec += until.tv_nsec / 1'000'000'000, until.tv_nsec %= 1'000'000'000;
        if (sem_timedwait(&waiting_, &until) == 0)
          take();
      }
    }
  }
  std::uint32_t matched_count() const noexcept { return reader_.matched_count(); }

 private:
  void on_data() {
    if (answers_in_listener_)
      return take();
    sem_post(&waiting_);
  }
  void take() {
    T sample;
    while (reader_.take(sample))
      answer_(sample);
  }

  bus::Reader<T> reader_;
  Answer answer_;
  bool answers_in_listener_;
  std::optional<bus::WaitSet> wait_set_;
  sem_t waiting_;
};

}  // namespace voxtouch::test

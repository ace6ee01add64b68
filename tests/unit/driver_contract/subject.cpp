#include "tests/unit/driver_contract/subject.hpp"

#include <chrono>

namespace voxtouch::contract {

using namespace std::chrono_literals;

void Subject::open() {
  driver_ = make();
  observe();
}

void Subject::look_after_fault() {
  if (fault_ == nullptr)
    return;
  const double now = now_s(), start = fault_start_s(*this);
  if (!began_s_ && now >= start - 1e-9) {
    if (!scheduled_faults() && !fault_->at_opening)
      begin_fault(*fault_);
    began_s_ = scheduled_faults() ? start : now;
  }
  if (began_s_ && !ended_ && now >= *began_s_ + fault_lasts_s(*this, *fault_) - 1e-9) {
    if (!scheduled_faults() && !fault_->at_opening)
      end_fault(*fault_);
    ended_ = true;
  }
}

Subject::Cycle Subject::cycle(const std::optional<Wrench>& command) {
  look_after_fault();
  const double before = now_s();
  const auto period =
      std::chrono::microseconds(static_cast<std::int64_t>(1e6 / driver_->description().rate_hz));
  Cycle t{driver_->read(virtual_time() ? period : 4 * period), {}, 0.0, {}};
  observe();
  t.time_s = now_s();
  if (scheduled_faults())
    look_after_fault();
  if (began_s_)
    t.last_error = driver_->last_error();
  if (command)
    t.written = driver_->write(*command);
  observe();
  if (now_s() == before) {
    pass_period();
    observe();
  }
  return t;
}

bool Subject::push_until_measured(const Wrench& command, double tolerance) {
  const auto give_up = std::chrono::steady_clock::now() + 20s;
  const double start = now_s();
  while (now_s() < start + 4.0 && std::chrono::steady_clock::now() < give_up) {
    const std::size_t before = received().size();
    for (int i = 0; i < 10; ++i)
      cycle(command);
    const std::vector<Received>& all = received();
    // In real time a period that a busy machine has skipped reads as the mean of two commands: the
    // one before it will do.
    const std::size_t last = all.size(),
                      first = virtual_time() && last > 0 ? last - 1 : std::min(before, last);
    for (std::size_t i = first; i < last; ++i) {
      const Wrench& got = all[i].wrench;
      if ((got.force - command.force).norm() <= tolerance * command.force.norm() &&
          got.torque.norm() < 0.1)
        return true;
    }
  }
  return false;
}

Subject::Another Subject::open_another() {
  try {
    return {make(), {}};
  } catch (const devices::DeviceOpenError& error) {
    return {nullptr, error.what()};
  }
}

const std::vector<Received>& Subject::received() {
  collect(received_);
  return received_;
}

}  // namespace voxtouch::contract

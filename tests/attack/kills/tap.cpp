#include "tests/attack/kills/tap.hpp"

#include <cmath>

#include "nodes/bus/wait_set.hpp"
#include "qos/topics.hpp"

namespace voxtouch::attack {

Tap::Tap(const bus::ParticipantOptions& joined, const std::string& rig)
    : participant_(joined),
      states_(participant_, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kTap)),
      commands_(participant_, qos::kForceCommand, rig, qos::profile(qos::ProfileId::kTap)),
      thread_([this] { listen(); }) {}

Tap::~Tap() {
  stop_.store(true);
  thread_.join();
}

void Tap::listen() {
  bus::WaitSet wait_set(participant_);
  wait_set.attach(states_.condition());
  wait_set.attach(commands_.condition());
  while (!stop_.load()) {
    wait_set.wait(20'000'000);
    states_.take_each([this](const msg::DeviceState& state, const dds_sample_info_t& info) {
      const std::lock_guard lock(mutex_);
      seen_.push_back({info.source_timestamp, state.sample_time_ns, state.sequence_number,
                       (state.flags & msg::device_state::kFlagForceOn) != 0});
    });
    msg::ForceCommand command;
    while (commands_.take(command))
      commanded_n_.store(
          std::hypot(command.wrench.force.x, command.wrench.force.y, command.wrench.force.z));
  }
}

std::vector<Seen> Tap::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

std::optional<Seen> Tap::newest() const {
  const std::lock_guard lock(mutex_);
  return seen_.empty() ? std::nullopt : std::optional(seen_.back());
}

}  // namespace voxtouch::attack

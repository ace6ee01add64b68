#include "devices/recorded/recorded_hand.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace voxtouch::recorded {
namespace {

constexpr double kSameNs = 1000.0;

Twist mixed(const Twist& a, const Twist& b, double t) noexcept {
  return {a.linear + t * (b.linear - a.linear), a.angular + t * (b.angular - a.angular)};
}

void require_playable(const RecordedHand& hand, double speed) {
  if (!(speed >= kMinSpeed && speed <= kMaxSpeed))
    throw std::runtime_error(
        fmt::format("a recorded hand is played at {} to {} times its speed, not {}", kMinSpeed,
                    kMaxSpeed, speed));
  if (hand.samples.empty())
    throw std::runtime_error("the recording holds no sample of a device");
  if (hand.samples.front().time_ns < 0)
    throw std::runtime_error(
        "the first recorded sample has a time before 0: the recording is damaged");
  for (std::size_t i = 0; i < hand.samples.size(); ++i) {
    const devices::DeviceSample& sample = hand.samples[i];
    if (!sample.pose.finite() || !sample.twist.finite())
      throw std::runtime_error(fmt::format("recorded sample {} holds a number that is none", i));
    if (i > 0 && sample.time_ns <= hand.samples[i - 1].time_ns)
      throw std::runtime_error(
          fmt::format("recorded sample {} is not later than the one before it", i));
  }
}

}  // namespace

HandPlayer::HandPlayer(RecordedHand hand, double speed)
    : hand_(std::move(hand)),
      speed_(speed),
      period_ns_(1e9 / hand_.description.rate_hz) {
  require_playable(hand_, speed);
  const auto lasts_ns =
      static_cast<double>(hand_.samples.back().time_ns - hand_.samples.front().time_ns);
  count_ = 1 + static_cast<std::uint64_t>((lasts_ns + kSameNs) / (speed_ * period_ns_));
}

devices::DeviceSample HandPlayer::played(devices::DeviceSample sample,
                                         std::uint64_t k) const noexcept {
  sample.time_ns = std::llround(static_cast<double>(k) * period_ns_);
  sample.twist.linear *= speed_;
  sample.twist.angular *= speed_;
  return sample;
}

devices::DeviceSample HandPlayer::sample(std::uint64_t k) noexcept {
  const auto& all = hand_.samples;
  if (k >= count_) {
    devices::DeviceSample last = all.back();
    last.twist = {};
    return played(last, k);
  }
  const double asked_ns = speed_ * static_cast<double>(k) * period_ns_;
  const auto after_first_ns = [&](std::size_t i) {
    return static_cast<double>(all[i].time_ns - all.front().time_ns);
  };
  if (after_first_ns(at_) > asked_ns + kSameNs)
    at_ = 0;
  while (at_ + 1 < all.size() && after_first_ns(at_ + 1) <= asked_ns + kSameNs)
    ++at_;
  const double past_ns = asked_ns - after_first_ns(at_);
  if (past_ns <= kSameNs || at_ + 1 == all.size())
    return played(all[at_], k);
  const devices::DeviceSample &before = all[at_], &next = all[at_ + 1];
  const double t = past_ns / (after_first_ns(at_ + 1) - after_first_ns(at_));
  devices::DeviceSample between = before;
  between.pose.position += t * (next.pose.position - before.pose.position);
  between.pose.orientation = before.pose.orientation.slerp(t, next.pose.orientation).normalized();
  between.twist = mixed(before.twist, next.twist, t);
  between.pose_valid = before.pose_valid && next.pose_valid;
  return played(between, k);
}

}  // namespace voxtouch::recorded

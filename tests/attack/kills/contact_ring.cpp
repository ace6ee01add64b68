#include "tests/attack/kills/contact_ring.hpp"

#include <signal.h>

#include <stdexcept>
#include <thread>

#include "nodes/security/key_folder.hpp"

namespace voxtouch::attack {
namespace {

using namespace std::chrono_literals;
constexpr double kMinForceN = 0.05;  // more than this is commanded: the hand feels the contact

}  // namespace

bool wait_until(const std::function<bool()>& holds, std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until)
      return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

ContactRing::ContactRing(const ContactRingOptions& ask) : ask_(ask) {
  std::vector<std::string> words{
      VOXTOUCH_BIN "/voxtouch",
      "up",
      ask.scene.contains('/') ? ask.scene : test::shipped_scene(ask.scene),
      "--json",
      "--no-report",
      "--domain",
      std::to_string(ask.domain),
      "--rig",
      ask.rig,
      "--motion",
      ask.motion,
      "--record",
      bag().string()};
  words.insert(words.end(), ask.more.begin(), ask.more.end());
  if (!ask.keys.empty())
    words.insert(words.end(), {"--security", ask.keys.string()});
  up_.emplace(words);
  tap_.emplace(joined("tap"), ask.rig);
}

bus::ParticipantOptions ContactRing::joined(const std::string& name) const {
  bus::ParticipantOptions options{ask_.domain, "lo", name};
  if (!ask_.keys.empty())
    options.security = security::properties_of(ask_.keys, "tool", ask_.rig);
  return options;
}

bool ContactRing::has_force() const {
  return tap_->newest()->force_on && tap_->commanded_n() > kMinForceN;
}

bool ContactRing::reach_contact(std::uint64_t behind, std::chrono::milliseconds after,
                                const std::function<bool()>& also) {
  const auto is_in_contact = [&] {
    return tap_->newest() && tap_->newest()->sequence > behind && has_force();
  };
  if ((also && !wait_until(also, 30s)) || !wait_until(is_in_contact, 30s))
    return false;
  std::this_thread::sleep_for(after);
  return wait_until([this] { return has_force(); }, 10s);
}

std::string ContactRing::refusal() {
  up_->signal(SIGINT);
  const test::Finished end = up_->wait(30s);
  return end.err + end.out;
}

void ContactRing::lose(pid_t victim, int signal) {
  if (victim <= 0)
    throw std::runtime_error(
        "the process that is to be lost is not there");  // 0 would be the test itself
  beats_.restart();
  lost_at_ns_ = unix_ns();
  ::kill(victim, signal);
}

}  // namespace voxtouch::attack

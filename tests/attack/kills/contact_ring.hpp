#pragma once
/// A ring of `voxtouch up` in contact, with a listener: the start of the rounds that lose a
/// process.
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/attack/kills/beat.hpp"
#include "tests/attack/kills/tap.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::attack {

/// Polls every 2 ms; false if the condition does not hold within `patience`.
bool wait_until(const std::function<bool()>& holds, std::chrono::milliseconds patience);

struct ContactRingOptions {
  std::string scene, motion;  ///< shipped ones; or the path of a scene file
  std::string rig = "haptic";
  std::uint32_t domain = 0;
  std::vector<std::string> more = {};  ///< options of `up`
  std::filesystem::path keys =
      {};  ///< folder of --security; empty: plain. DDS takes one set of keys a process and domain
};

class ContactRing {
 public:
  /// Starts `up`. Throws if it cannot be started or monitored.
  explicit ContactRing(const ContactRingOptions& ask);

  /// Waits for force and a displayed contact after sample `behind`, then `after` longer, and for
  /// the contact to be displayed then. `also`: an additional condition before. False if this does
  /// not occur.
  bool reach_contact(std::uint64_t behind, std::chrono::milliseconds after,
                     const std::function<bool()>& also = {});
  /// Output of `up` if the contact was not reached; ends `up`.
  std::string refusal();
  /// Sends the signal, and stores its time. Throws if the process does not exist.
  void lose(pid_t victim, int signal);
  std::int64_t lost_at_ns() const noexcept { return lost_at_ns_; }  ///< Unix time
  /// The longest time since then that the machine kept a thread of the ring's priority waiting
  /// [ms].
  double machine_ms() const noexcept { return 1e-6 * static_cast<double>(beats_.longest_ns()); }
  bool has_force() const;
  /// All samples of the device that were received.
  std::vector<Seen> seen() const { return tap_->seen(); }
  void stop_listening() { tap_.reset(); }

  test::Process& up() noexcept { return *up_; }
  std::filesystem::path bag() const { return folder_ / "bag"; }
  /// How another participant of this test joins.
  bus::ParticipantOptions joined(const std::string& name) const;

 private:
  ContactRingOptions ask_;
  test::TemporaryFolder folder_;
  std::optional<test::Process> up_;
  std::optional<Tap> tap_;
  Beats beats_;
  std::int64_t lost_at_ns_ = 0;
};

}  // namespace voxtouch::attack

#pragma once
/// The device as any participant on the network may watch it, without a word to the ring.
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "nodes/bus/reader.hpp"

namespace voxtouch::attack {

/// One sample of the device. Its reception time is unreliable if this process itself was suspended.
struct Seen {
  std::int64_t written_ns = 0;  ///< when the device wrote it, by DDS; Unix time
  std::int64_t sample_ns = 0;   ///< device clock
  std::uint64_t sequence = 0;
  bool force_on = false;  ///< the guard outputs force
};

class Tap {
 public:
  Tap(const bus::ParticipantOptions& joined, const std::string& rig);
  ~Tap();

  std::vector<Seen> seen() const;
  std::optional<Seen> newest() const;
  /// Force of the newest command [N].
  double commanded_n() const noexcept { return commanded_n_.load(); }

 private:
  void listen();
  bus::Participant participant_;
  bus::Reader<msg::DeviceState> states_;
  bus::Reader<msg::ForceCommand> commands_;
  mutable std::mutex mutex_;
  std::vector<Seen> seen_;
  std::atomic<double> commanded_n_{0.0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::attack

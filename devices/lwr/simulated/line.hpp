#pragma once
/// The network between controller and remote side, as bad as the schedule says. No socket: what goes in comes out, or not.
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "devices/lwr/fri_packets.hpp"
#include "devices/lwr/simulated/faults.hpp"

namespace voxtouch::lwr_sim {

/// Measurements on their way, ordered by when they leave. Random decisions come from one generator a kind of fault, so that one
/// fault does not change another's dice; the same seed and calls give the same decisions. Real-time safe after construction.
class Line {
 public:
  Line(FaultSchedule faults, double period_s, std::uint64_t seed);

  struct Packet {
    double due_s = 0.0;
    double sent_s = 0.0;  ///< when it would have left
    lwr::fri::MsrPacket msr{};
  };
  struct Counts {
    std::uint64_t lost = 0, delayed = 0, reordered = 0, duplicated = 0, answers_lost = 0;
  };

  /// A measurement made at `now_s`.
  void put(const lwr::fri::MsrPacket& msr, double now_s) noexcept;
  /// The next one that leaves before `until_s`; null: none. Valid until the next call.
  const Packet* take(double until_s) noexcept;
  /// When the next one leaves; infinity: none waits.
  double next_due_s() const noexcept;
  /// Does an answer that arrives now get lost?
  bool loses_answer(double now_s) noexcept;
  bool silent(double now_s) const noexcept { return faults_.active(FaultKind::kSilent, now_s).has_value(); }
  const Counts& counts() const noexcept { return counts_; }

 private:
  bool happens(FaultKind kind, double now_s) noexcept;
  double uniform(FaultKind kind) noexcept;
  void queue(const lwr::fri::MsrPacket& msr, double now_s, double delay_s) noexcept;

  FaultSchedule faults_;
  double period_s_;
  std::array<std::mt19937_64, kFaultKinds> dice_;
  std::vector<Packet> waiting_;  // by due time; capacity fixed
  Packet taken_;
  bool reordering_ = false;
  Counts counts_;
};

}  // namespace voxtouch::lwr_sim

#pragma once
/// Who plays a role for this node: which one participant the device, the rendering or the coupling
/// is.
#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/participant_counts.hpp"

namespace voxtouch::runtime {

/// The rule. A participant claims a role with a node status that is its own (the registry knows no
/// others), says the role's name, a session and that it is starting, ready or running, and with a
/// writer on each of the role's topics here. The only claimant is bound; of two none is. In a ring
/// that `voxtouch up` started only participants that its claim names are bound. In one that was
/// started by hand a binding lasts as long as its session: if the participant goes, the role is
/// lost until another session begins. The samples of all others are refused, counted and named. One
/// thread, the housekeeping's, owns it; `session`, `bound` and `binding_epoch` may be asked by any.
class RoleBinding {
 public:
  /// `inputs`: this node's readers of what the role writes. They follow whoever is bound.
  RoleBinding(std::string role, std::vector<bus::Following*> inputs)
      : role_(std::move(role)),
        inputs_(std::move(inputs)) {}

  /// `session`: only who has answered for it may claim; none: for any.
  void update(const NodeRegistry& registry, std::optional<std::uint64_t> session);

  bool bound() const noexcept { return bound_now_.load(std::memory_order_acquire); }
  const std::optional<bus::Guid>& participant() const noexcept { return participant_; }
  /// The session in which the bound participant went, in a ring that was started by hand; 0: it did
  /// not, or another session has begun.
  std::uint64_t lost_session() const noexcept { return lost_session_; }
  /// What the bound participant's status says; 0: no participant is bound. Real-time safe.
  std::uint64_t session() const noexcept { return session_.load(std::memory_order_acquire); }
  /// Another number for each binding. Real-time safe.
  std::uint64_t binding_epoch() const noexcept {
    return binding_epoch_.load(std::memory_order_acquire);
  }
  /// Samples of others that came while a participant was bound.
  std::uint64_t refused() const noexcept;
  /// Whose samples were refused and how many, also of those that have gone.
  std::string refused_writers() const { return refused_from_.text(); }
  /// What a person must know: two that claim, or who is refused. Empty: nothing.
  std::string diagnostic(const NodeRegistry& registry) const;

 private:
  bool is_claimed_by(const NodeReport& report) const;
  std::vector<bus::Guid> claimants(const NodeRegistry& registry,
                                   std::optional<std::uint64_t> session) const;
  void bind(const bus::Guid& participant);
  void let_go();
  void follow_again();
  void note_refused(const NodeRegistry& registry);
  void note_others(const NodeRegistry& registry);

  std::string role_;
  std::vector<bus::Following*> inputs_;
  std::optional<bus::Guid> participant_;
  std::vector<bus::Guid> conflicting_;  ///< two or more claimants while none is bound
  ParticipantCounts refused_from_;
  std::set<bus::Guid>
      others_;  ///< whose samples or claims have been refused, and who are still there
  std::uint64_t lost_session_ = 0;
  std::atomic<bool> bound_now_{false};
  std::atomic<std::uint64_t> session_{0}, binding_epoch_{0};
};

}  // namespace voxtouch::runtime

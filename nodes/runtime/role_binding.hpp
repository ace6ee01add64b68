#pragma once
/// Who plays a role for this node: which one participant the device, the rendering or the coupling
/// is, and which one stands by.
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/pair_reader.hpp"

namespace voxtouch::runtime {

/// The rule. A participant claims a role with a node status that is its own (the registry knows no
/// others), says the role's name, a session and that it is starting, ready or running, and with a
/// writer on each of the role's topics here. The one that claims while nobody is bound is bound; of
/// two that claim then none is. Whoever is bound stays it until his participant has gone; then the
/// next one takes the role. The samples of all others are refused, counted and named.
///
/// Where the role may have a standby (`pair`): the one that the bound participant names in its
/// status stands by. The loop decides by what the two answer who of them acts (Failover), and who
/// acts is bound. The other one stays in its place until it has gone, or the one that acts names
/// another. A bound participant that has gone is not let go while its standby is there: it takes
/// over, or it goes too. One thread, the housekeeping's, owns it; `session`, `bound` and `tenure`
/// may be asked by any.
class RoleBinding {
 public:
  /// `inputs`: this node's readers of what the role writes, but for the one of its answers where
  /// that is a `pair`. They follow whoever is bound.
  RoleBinding(std::string role, std::vector<bus::Following*> inputs, PairInput* pair = nullptr)
      : role_(std::move(role)),
        inputs_(std::move(inputs)),
        pair_(pair) {}

  /// `session`: only who has answered for it may claim; none: for any.
  void update(const NodeRegistry& registry, std::optional<std::uint64_t> session);

  bool bound() const noexcept { return bound_now_.load(std::memory_order_acquire); }
  const std::optional<bus::Guid>& participant() const noexcept { return at(acting_); }
  const std::optional<bus::Guid>& standby() const noexcept { return at(other_than(acting_)); }
  /// What the bound participant's status says; 0: nobody is bound. Real-time safe.
  std::uint64_t session() const noexcept { return session_.load(std::memory_order_acquire); }
  /// Another number each time that somebody is bound who did not stand by before. Real-time safe.
  std::uint64_t tenure() const noexcept { return tenure_.load(std::memory_order_acquire); }
  /// Samples of others that came while somebody was bound.
  std::uint64_t refused() const noexcept;
  /// What a person must know: two that claim, or who is refused. Empty: nothing.
  std::string trouble(const NodeRegistry& registry) const;
  /// What is counted of a standby, where there has been one: `fenced_answers`, `takeovers`, and who
  /// is fenced.
  void report_to(NodeReport& report, const NodeRegistry& registry) const;

 private:
  using Place = Failover::Place;
  const std::optional<bus::Guid>& at(Place place) const noexcept {
    return places_[place == Place::kFirst ? 0 : 1];
  }
  std::optional<bus::Guid>& at(Place place) noexcept {
    return places_[place == Place::kFirst ? 0 : 1];
  }
  std::vector<bus::Following*> all_inputs() const;
  std::vector<bus::Guid> claimants(const NodeRegistry& registry,
                                   std::optional<std::uint64_t> session) const;
  void bind(const bus::Guid& participant);
  void let_go();
  void follow_failover();
  bool stands_in(const NodeRegistry& registry) const;
  void follow_again();
  void look_for_standby(const NodeRegistry& registry);
  void fill_other_place(const bus::Guid& participant);
  void clear_other_place();
  void note_others(const NodeRegistry& registry);

  std::string role_;
  std::vector<bus::Following*> inputs_;
  PairInput* pair_;
  Place acting_ = Place::kFirst;  ///< the bound one's; without a pair the first
  std::array<std::optional<bus::Guid>, 2> places_;
  std::vector<bus::Guid> rivals_;  ///< who claim while nobody is bound, two or more
  std::set<bus::Guid>
      others_;  ///< whose samples or claims have been refused, and who are still there
  std::atomic<bool> bound_now_{false};
  std::atomic<std::uint64_t> session_{0}, tenure_{0};
};

}  // namespace voxtouch::runtime

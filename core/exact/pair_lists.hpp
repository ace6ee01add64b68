#pragma once
/// Which features of an object are near each feature of the tool, and how long that holds.
///
/// The *path* of the tool is the sum of what each step moves any of its points at most. Each leaf
/// of the tool's tree (one feature) lists its pairs within a radius, and the path `until` which
/// nothing unlisted can be nearer than zero: the path at which it was listed and the least distance
/// of what was left out. A node holds the least of its children, or what its ball's distance from
/// the object gives. So a frame renews only what expires, renewing may stop after any leaf, and the
/// root's `until` says how far the tool may go.
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/exact/limits.hpp"
#include "core/exact/pair_probe.hpp"

namespace voxtouch::exact {

/// What a renewal is asked for. All in metres of path.
struct Renewal {
  double path_m = 0.0;  ///< of the tool so far
  double need_m = 0.0;  ///< what is nearer than this must be listed
  double radius_m =
      0.0;  ///< what is nearer than this is listed by a leaf that is renewed; above `need_m`
};

/// The pairs of one kind between a tool and an object, which must outlive it. All memory is taken
/// at construction.
template <class Probe>
class PairLists {
 public:
  /// `capacity`: the most pairs that all lists hold together.
  PairLists(const ToolBody& tool, const ObjectBody& object, std::size_t capacity)
      : tool_(tool),
        object_(object),
        tree_(Probe::elements(tool)),
        items_(Probe::items(object)) {
    states_.resize(tree_.nodes().size());
    heads_.assign(tree_.elements(), kNone);
    blocks_.resize(std::max<std::size_t>(tree_.elements(), capacity / kBlockPairs));
    scratch_.reserve(limits::kMaxListed);
    reset();
  }

  std::size_t bytes() const noexcept {
    return states_.size() * sizeof(State) + heads_.size() * sizeof(std::uint32_t) +
           blocks_.size() * sizeof(Block) + scratch_.capacity() * sizeof(Pair);
  }

  /// Forgets all lists. Real-time safe.
  void reset() noexcept {
    std::fill(states_.begin(), states_.end(), State{});
    std::fill(heads_.begin(), heads_.end(), kNone);
    for (std::size_t k = 0; k < blocks_.size(); ++k)
      blocks_[k].next = k + 1 < blocks_.size() ? static_cast<std::uint32_t>(k + 1) : kNone;
    free_ = blocks_.empty() ? kNone : 0;
  }

  /// Renews what does not hold for `need_m` more, as far as `work` lasts. Real-time safe.
  void renew(PosedPoints& posed, const Renewal& renewal, Work& work) noexcept {
    if (!tree_.nodes().empty() && !items_.empty())
      renew_node(0, {}, posed, renewal, work);
  }

  /// The path until which everything that can touch is listed.
  double until_m() const noexcept {
    return tree_.nodes().empty() || items_.empty() ? kInfinity : states_[0].until_m;
  }
  /// No listed pair touches before this path.
  double nearest_m() const noexcept {
    return tree_.nodes().empty() || items_.empty() ? kInfinity : states_[0].nearest_m;
  }

  /// Calls `visit(element, item, distance)` for each listed pair that may be nearer than `reach_m`,
  /// after its distance was found exactly and is. False, and incomplete, where `visit` returned
  /// false or the limit of work was reached; what was evaluated need not be again for a smaller
  /// reach. Real-time safe.
  template <class Visit>
  bool visit_near(PosedPoints& posed, double path_m, double reach_m, Visit&& visit,
                  Work& work) noexcept {
    if (tree_.nodes().empty() || items_.empty())
      return true;
    return visit_node(0, posed, path_m, reach_m, visit, work);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr std::size_t kBlockPairs = 7;

  struct State {
    double until_m = -kInfinity, nearest_m = kInfinity;
  };
  struct Pair {
    double touches_m = 0.0;  ///< the path before which it does not touch
    std::uint32_t item = 0;
  };
  struct Block {
    std::array<Pair, kBlockPairs> pairs;
    std::uint32_t count = 0, next = kNone;
  };

  /// `entry`: where the items within the radius of the node's parent are.
  void renew_node(std::uint32_t at, BoxTree::Entry entry, PosedPoints& posed,
                  const Renewal& renewal, Work& work) noexcept {
    State& state = states_[at];
    if (state.until_m >= renewal.path_m + renewal.need_m || work.done())
      return;
    const ElementTree::Node& node = tree_.nodes()[at];
    if (node.leaf)
      return renew_leaf(state, node.element, entry, posed, renewal, work);
    // Where a renewal that was cut short goes on, the node itself is known to be near.
    const double known = std::max(states_[at + 1].until_m, states_[node.next].until_m);
    if (known < renewal.path_m + renewal.need_m) {
      const double beyond = distance_beyond(node.ball, entry, posed, renewal.radius_m, work);
      if (beyond > renewal.radius_m) {
        state.until_m = renewal.path_m + beyond;
        return;
      }
    }
    renew_node(at + 1, entry, posed, renewal, work);
    renew_node(node.next, entry, posed, renewal, work);
    const State &first = states_[at + 1], &second = states_[node.next];
    state.until_m = std::min(first.until_m, second.until_m);
    state.nearest_m = std::min(first.nearest_m, second.nearest_m);
  }

  /// A lower bound of the ball's distance from all items; 0 where some item lies within `radius_m`.
  /// Of items the distance is exact: boxes of large triangles that lie askew decide nothing.
  /// Narrows `entry` to the ball.
  double distance_beyond(const Ball& ball, BoxTree::Entry& entry, const PosedPoints& posed,
                         double radius_m, Work& work) const noexcept {
    const Vec3 centre = posed.rotation() * ball.centre + posed.pose().position;
    const auto bound = [&](const Box& box) {
      return (box.low - centre).cwiseMax(centre - box.high).cwiseMax(0.0).norm() - ball.radius;
    };
    entry = items_.enter(bound, radius_m, entry, work);
    if (!entry.near)
      return entry.outside_m;
    double beyond = kInfinity;
    const auto visit = [&](std::uint32_t item) {
      work.add(Work::kPair);
      beyond = std::min(beyond, Probe::distance(object_, item, centre) - ball.radius);
      return beyond > radius_m;
    };
    const auto walked = items_.walk(bound, radius_m, visit, work, entry);
    return walked.whole ? std::min(beyond, walked.beyond_m) : 0.0;
  }

  void renew_leaf(State& state, std::uint32_t element, const BoxTree::Entry& entry,
                  PosedPoints& posed, const Renewal& renewal, Work& work) noexcept {
    const Probe probe(tool_, object_, posed, element);
    const auto bound = [&](const Box& box) { return probe.bound(box); };
    double radius = renewal.radius_m;
    for (;; radius *= 0.5) {
      scratch_.clear();
      double beyond = kInfinity;
      bool fits = true;
      const auto list = [&](std::uint32_t item) {
        const double distance = probe.distance(item);
        work.add(Work::kPair);
        if (distance > radius) {
          beyond = std::min(beyond, distance);
          return true;
        }
        fits = scratch_.size() < scratch_.capacity();
        if (fits)
          scratch_.push_back({renewal.path_m + distance, item});
        return fits;
      };
      const auto walked = items_.walk(bound, radius, list, work, entry);
      if (walked.whole && store(element, renewal.path_m)) {
        state.until_m = renewal.path_m + std::min(beyond, walked.beyond_m);
        state.nearest_m = kInfinity;
        for (const Pair& pair : scratch_)
          state.nearest_m = std::min(state.nearest_m, pair.touches_m);
        return;
      }
      const bool too_many = !fits || walked.whole;
      if (!too_many || radius < limits::kMarginM || work.done())
        return;  // what was listed before stays
    }
  }

  /// Makes what is in `scratch_` the list of `element`; false, and nothing changed, without room
  /// for it.
  bool store(std::uint32_t element, double path_m) noexcept {
    const std::size_t requested = (scratch_.size() + kBlockPairs - 1) / kBlockPairs;
    if (!has_free(requested, element)) {
      give_back_expired(path_m);
      if (!has_free(requested, element))
        return false;
    }
    give_back(element);
    for (std::size_t first = 0; first < scratch_.size(); first += kBlockPairs) {
      const std::uint32_t taken = free_;
      Block& block = blocks_[taken];
      free_ = block.next;
      block.count = static_cast<std::uint32_t>(std::min(kBlockPairs, scratch_.size() - first));
      for (std::size_t k = 0; k < block.count; ++k)
        block.pairs[k] = scratch_[first + k];
      block.next = heads_[element];
      heads_[element] = taken;
    }
    return true;
  }

  bool has_free(std::size_t requested, std::uint32_t element) const noexcept {
    std::size_t found = 0;
    for (std::uint32_t b = heads_[element]; b != kNone && found < requested; b = blocks_[b].next)
      ++found;
    for (std::uint32_t b = free_; b != kNone && found < requested; b = blocks_[b].next)
      ++found;
    return found >= requested;
  }

  void give_back(std::uint32_t element) noexcept {
    while (heads_[element] != kNone) {
      Block& block = blocks_[heads_[element]];
      const std::uint32_t next = block.next;
      block.next = free_;
      free_ = heads_[element];
      heads_[element] = next;
    }
  }

  /// Lists of leaves that have expired are of no use. A leaf whose own list holds keeps it, however
  /// far its parent is: it would be taken for complete later.
  void give_back_expired(double path_m) noexcept {
    for (std::size_t at = 0; at < states_.size(); ++at) {
      const ElementTree::Node& node = tree_.nodes()[at];
      if (!node.leaf || states_[at].until_m > path_m)
        continue;
      give_back(node.element);
      states_[at].nearest_m = kInfinity;
    }
  }

  template <class Visit>
  bool visit_node(std::uint32_t at, PosedPoints& posed, double path_m, double reach_m, Visit& visit,
                  Work& work) noexcept {
    State& state = states_[at];
    if (state.nearest_m > path_m + reach_m)
      return true;
    if (work.done())
      return false;
    const ElementTree::Node& node = tree_.nodes()[at];
    if (!node.leaf) {
      const bool whole = visit_node(at + 1, posed, path_m, reach_m, visit, work) &&
                         visit_node(node.next, posed, path_m, reach_m, visit, work);
      state.nearest_m = std::min(states_[at + 1].nearest_m, states_[node.next].nearest_m);
      return whole;
    }
    const Probe probe(tool_, object_, posed, node.element);
    bool whole = true;
    state.nearest_m = kInfinity;
    for (std::uint32_t b = heads_[node.element]; b != kNone; b = blocks_[b].next) {
      Block& block = blocks_[b];
      for (std::size_t k = 0; k < block.count; ++k) {
        Pair& pair = block.pairs[k];
        if (whole && pair.touches_m <= path_m + reach_m) {
          const double distance = probe.distance(pair.item);
          work.add(Work::kPair);
          pair.touches_m = path_m + distance;
          if (distance <= reach_m)
            whole = visit(node.element, pair.item, distance);
        }
        state.nearest_m = std::min(state.nearest_m, pair.touches_m);
      }
    }
    return whole;
  }

  const ToolBody& tool_;
  const ObjectBody& object_;
  const ElementTree& tree_;
  const BoxTree& items_;
  std::vector<State> states_;         ///< one a node
  std::vector<std::uint32_t> heads_;  ///< first block of each element's list
  std::vector<Block> blocks_;
  std::uint32_t free_ = kNone;
  std::vector<Pair> scratch_;
};

}  // namespace voxtouch::exact

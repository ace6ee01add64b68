#pragma once
/// Lists of near pairs: a feature of the tool (element) and a feature of the object (item).
///
/// The path of the tool is the sum of its steps, each a bound of the displacement of any point. A
/// leaf of the tool's tree is one element. It lists its pairs within a radius and is valid up to
///
///     until = path when listed + least distance of the pairs that are not listed     [m]
///
/// A node has the least value of its children, or that of its ball. A frame renews expired nodes
/// only and may stop after any leaf. The root's value limits the step.
///
/// The path ignores directions: a pin that slides along its hole would expire all lists. So each
/// pair keeps a separating plane, and a leaf or small node one that has all near items below it.
/// Heights above planes are checked before any search.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/exact/limits.hpp"
#include "core/exact/pair_store.hpp"

namespace voxtouch::exact {

/// Input of a renewal.
struct Renewal {
  double path_m = 0.0;      ///< present path of the tool
  double rotation_m = 0.0;  ///< part of the path that is due to rotations
  double need_m = 0.0;      ///< lists that are valid for this further path are not renewed
  double radius_m =
      0.0;  ///< a renewed leaf lists the pairs within this distance; greater than `need_m`
  double room_m = 0.0;  ///< a plane replaces lists if it is kPlaneReaches times this below them
};

/// A step to be checked.
struct Step {
  double path_m = 0.0;      ///< path of the tool at its start
  double rotation_m = 0.0;  ///< part of the path that is due to rotations
  double length_m = 0.0;    ///< bound of the displacement of each point of the tool
  double seen_m = 0.0;      ///< the caller checks the pairs within this distance itself
};

enum class StepVerdict : std::uint8_t { kClear, kMayTouch, kUnknown };

/// The pairs of one kind (`Probe`) between a tool and an object, which must outlive it. The
/// constructor allocates all memory. Arguments `path_m` and `rotation_m` are those of Renewal.
template <class Probe>
class PairLists {
 public:
  /// `capacity`: pairs for which all lists together have room, at least.
  PairLists(const ToolBody& tool, const ObjectBody& object, std::size_t capacity)
      : tool_(tool),
        object_(object),
        tree_(Probe::elements(tool)),
        items_(Probe::items(object)),
        states_(tree_.nodes().size()),
        planes_(states_.size()),
        store_(tree_.elements(), blocks_for(tree_.elements(), capacity)) {
    scratch_.reserve(limits::kMaxListed);
  }

  std::size_t bytes() const noexcept {
    return states_.size() * (sizeof(State) + sizeof(Plane)) + store_.bytes() +
           scratch_.capacity() * sizeof(Pair);
  }

  /// Discards all lists. Real-time safe.
  void reset() noexcept {
    std::fill(states_.begin(), states_.end(), State{});
    std::fill(planes_.begin(), planes_.end(), Plane{});
    store_.reset();
  }

  /// Renews the lists that are not valid for a further path of `need_m`, until the limit of work.
  /// Real-time safe.
  void renew(PosedPoints& posed, const Renewal& renewal, Work& work) noexcept {
    if (!tree_.nodes().empty() && !items_.empty())
      renew_node(0, {}, posed, renewal, work);
  }

  /// Further path for which all lists are valid [m].
  double holds_for_m(double path_m, double rotation_m) const noexcept {
    if (tree_.nodes().empty() || items_.empty())
      return kInfinity;
    return std::min(states_[0].until_m - path_m, states_[0].rotation_until_m - rotation_m);
  }
  /// Path up to which no listed pair touches [m].
  double nearest_m() const noexcept {
    return tree_.nodes().empty() || items_.empty() ? kInfinity : states_[0].nearest_m;
  }

  /// Calls `visit(element, item, distance, plane)` for each listed pair that may touch within a
  /// further path of `reach_m`, with the result of `touches_after`. Returns false, incomplete, if
  /// `visit` does or at the limit of work. A repetition with a smaller reach skips the pairs found
  /// beyond it. Real-time safe.
  template <class Visit>
  bool visit_near(PosedPoints& posed, double path_m, double reach_m, Visit&& visit,
                  Work& work) noexcept {
    if (tree_.nodes().empty() || items_.empty())
      return true;
    return visit_node(0, posed, path_m, reach_m, visit, work);
  }

  /// Whether a pair that is farther than `step.seen_m` may touch on the straight step from `posed`
  /// to `next`, or be within the margin at its end. Renews the lists that it needs. kUnknown: the
  /// limit of work, or no room for a list. Real-time safe.
  StepVerdict check_step(PosedPoints& posed, PosedPoints& next, const Step& step,
                         Work& work) noexcept {
    if (tree_.nodes().empty() || items_.empty())
      return StepVerdict::kClear;
    return check_node(0, posed, next, step, work);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct State {
    double until_m = -kInfinity, nearest_m = kInfinity;
    double near_m = -kInfinity;  ///< an item is within `path_m - near_m` of the node's ball
    /// Like `until_m`, of `rotation_m`: for items that are not listed because they face away.
    double rotation_until_m = kInfinity;

    bool holds(double path_m, double rotation_m, double need_m) const noexcept {
      return until_m >= path_m + need_m && rotation_until_m >= rotation_m + need_m;
    }
  };
  /// A plane with all near items below it, in the object's frame.
  struct Plane {
    Vec3 normal = Vec3::Zero();  ///< unit, from the object to the tool; zero: no plane
    double height_m = 0.0;
    double until_m = -kInfinity;       ///< items above the plane cannot touch before this path
    double retry_m = -kInfinity;       ///< no new plane is computed before this path
    double retry_away_m = -kInfinity;  ///< `faces_away` is not repeated before this path
  };
  struct Pair {
    double touches_m = 0.0;  ///< path up to which the pair does not touch
    std::uint32_t item = 0;
    Vec3 apart = Vec3::Zero();  ///< shortest vector from the item to the element [m]
  };
  using Block = PairStore::Block;

  /// Blocks for `capacity` pairs, at least for kListedPairs of each element.
  static std::size_t blocks_for(std::size_t elements, std::size_t capacity) noexcept {
    const std::size_t of_one = limits::kListedPairs / PairStore::kBlockPairs + 1;
    return std::max<std::size_t>(of_one * elements, capacity / PairStore::kBlockPairs);
  }

  /// `entry`: where searches start, with all items near the parent of the node.
  void renew_node(std::uint32_t at, BoxTree::Entry entry, PosedPoints& posed,
                  const Renewal& renewal, Work& work) noexcept {
    State& state = states_[at];
    if (state.holds(renewal.path_m, renewal.rotation_m, renewal.need_m) || work.done())
      return;
    const ElementTree::Node& node = tree_.nodes()[at];
    if (kept_by_plane(at, posed, renewal, work))
      return;
    if (node.leaf) {
      if (!faces_away(at, entry, posed, renewal, work))
        renew_leaf(at, entry, true, posed, renewal, work);
      return;
    }
    // If a child is valid, as after a renewal that was cut short, the node is not tested again.
    const double known = std::max(states_[at + 1].until_m, states_[node.next].until_m);
    if (known < renewal.path_m + renewal.need_m) {
      if (is_far(at, entry, posed, renewal.path_m, renewal.radius_m, work))
        return;
      if (std::isfinite(node.spread_m) && find_plane(at, entry, posed, renewal, work))
        return;
      if (faces_away(at, entry, posed, renewal, work))
        return;
    }
    renew_node(at + 1, entry, posed, renewal, work);
    renew_node(node.next, entry, posed, renewal, work);
    const State &first = states_[at + 1], &second = states_[node.next];
    state.until_m = std::min(first.until_m, second.until_m);
    state.rotation_until_m = std::min(first.rotation_until_m, second.rotation_until_m);
    state.nearest_m = std::min(first.nearest_m, second.nearest_m);
  }

  /// Bound of the rotation before which an item's normals face those of the node's elements.
  auto rotation_bound_of(std::uint32_t at, const PosedPoints& posed) const noexcept {
    return typename Probe::RotationBoundOf(tree_.nodes()[at].cone, posed.rotation(),
                                           tool_.features().reach_m);
  }
  /// Further path up to which a pair cannot touch [m]: its distance or, within `range_m`, the
  /// rotation until its normals face each other, if that is larger.
  template <class RotationBoundOf>
  double touches_after(double distance_m, double range_m, const RotationBoundOf& rotation_bound,
                       std::uint32_t item) const noexcept {
    if (distance_m > range_m)
      return distance_m;
    return std::max(distance_m, rotation_bound.path_m(Probe::cone(object_, item)));
  }

  /// Whether no item is within `radius_m` of the node's ball; the node is then valid for the
  /// distance of the nearest one. Narrows `entry` to the items near the ball. Item distances are
  /// exact: the box of a large oblique triangle is too large to decide.
  bool is_far(std::uint32_t at, BoxTree::Entry& entry, const PosedPoints& posed, double path_m,
              double radius_m, Work& work) noexcept {
    const Ball& ball = tree_.nodes()[at].ball;
    const Vec3 centre = posed.rotation() * ball.centre + posed.pose().position;
    const auto bound = [&](const Box& box) {
      return (box.low - centre).cwiseMax(centre - box.high).cwiseMax(0.0).norm() - ball.radius;
    };
    entry = items_.enter(bound, plane_range(radius_m), entry, work);
    if (!entry.near) {
      keep_until(at, path_m + entry.outside_m);
      return true;
    }
    if (path_m - radius_m <= states_[at].near_m)
      return false;
    double beyond = kInfinity;
    const auto visit = [&](std::uint32_t item) {
      work.add(Work::kPair);
      beyond = std::min(beyond, Probe::distance(object_, item, centre) - ball.radius);
      return beyond > radius_m;
    };
    const auto walked = items_.walk(bound, radius_m, visit, work, entry);
    states_[at].near_m = path_m - beyond;
    if (!walked.whole)
      return false;
    keep_until(at, path_m + std::min(beyond, walked.beyond_m));
    return true;
  }

  /// Whether no item within kPlaneReaches * `need_m` has normals that face the node's. If so, the
  /// node is valid until one is nearer, or may face it by rotation.
  bool faces_away(std::uint32_t at, const BoxTree::Entry& entry, const PosedPoints& posed,
                  const Renewal& renewal, Work& work) noexcept {
    if constexpr (std::is_same_v<typename Probe::RotationBoundOf, NoRotationBound>)
      return false;
    const ElementTree::Node& node = tree_.nodes()[at];
    Plane& plane = planes_[at];
    if (node.cone.half_rad() > limits::kWidestCone || renewal.path_m < plane.retry_away_m)
      return false;
    const Vec3 centre = posed.rotation() * node.ball.centre + posed.pose().position;
    const auto rotation_bound = rotation_bound_of(at, posed);
    const double near = limits::kPlaneReaches * renewal.need_m;
    double range = plane_range(renewal.need_m), rotation_m = kInfinity;
    const auto away = [&](const NormalCone& cone) {
      const double path = rotation_bound.path_m(cone);
      if (path > near)
        rotation_m = std::min(rotation_m, path);
      return path > near;
    };
    const auto bound = [&](const Box& box, const NormalCone& cone) {
      const double distance =
          (box.low - centre).cwiseMax(centre - box.high).cwiseMax(0.0).norm() - node.ball.radius;
      return distance <= range && away(cone) ? kInfinity : distance;
    };
    const auto visit = [&](std::uint32_t item) {
      work.add(Work::kPair);
      const double distance = Probe::distance(object_, item, centre) - node.ball.radius;
      if (distance < range && !away(Probe::cone(object_, item)))
        range = distance;
      return range > near;
    };
    const auto walked = items_.walk(bound, range, visit, work, entry);
    const double beyond = std::min(range, walked.beyond_m);
    if (!walked.whole || !(beyond > near)) {
      plane.retry_away_m = renewal.path_m + limits::kPlaneRetryM;
      return false;
    }
    keep_until(at, renewal.path_m + beyond);
    states_[at].rotation_until_m = renewal.rotation_m + rotation_m;
    return true;
  }

  /// Whether the node's elements are above its plane for a further path of `need_m`.
  bool kept_by_plane(std::uint32_t at, const PosedPoints& posed, const Renewal& renewal,
                     Work& work) noexcept {
    const Plane& plane = planes_[at];
    if (plane.until_m < renewal.path_m + renewal.need_m)
      return false;
    const double above = lowest(at, plane.normal, posed, work) - plane.height_m;
    const double holds = std::min(above, plane.until_m - renewal.path_m);
    if (holds < renewal.need_m)
      return false;
    keep_until(at, renewal.path_m + holds);
    return true;
  }

  /// Sets the path up to which the node is valid without lists.
  void keep_until(std::uint32_t at, double until_m) noexcept {
    states_[at].until_m = until_m;
    states_[at].rotation_until_m = kInfinity;
    states_[at].nearest_m = std::max(states_[at].nearest_m, until_m);
  }

  /// Least height of the node's elements along `n`, in the object's frame [m].
  double lowest(std::uint32_t at, const Vec3& n, const PosedPoints& posed,
                Work& work) const noexcept {
    const Vec3 n_T = posed.rotation().transpose() * n;
    double least = kInfinity;
    const std::uint32_t count = tree_.nodes()[at].count;
    for (std::uint32_t k = at; k < at + 2 * count - 1; ++k)
      if (tree_.nodes()[k].leaf)
        least = std::min(least, Probe::lowest(tool_, tree_.nodes()[k].element, n_T));
    work.add(1 + count / 2);
    return least + n.dot(posed.pose().position);
  }

  static double plane_range(double need_m) noexcept {
    return std::max(limits::kPlaneRangeM, 3.0 * need_m);
  }

  /// Sets a plane across the shortest vector from the object to the node's middle element. Returns
  /// false if there is none.
  bool find_plane(std::uint32_t at, const BoxTree::Entry& entry, PosedPoints& posed,
                  const Renewal& renewal, Work& work) noexcept {
    Plane& plane = planes_[at];
    if (renewal.path_m < plane.retry_m)
      return false;
    plane.retry_m = renewal.path_m + limits::kPlaneRetryM;
    const Probe probe(tool_, object_, posed, tree_.nodes()[at].element);
    double nearest = plane_range(renewal.need_m);
    Vec3 apart = Vec3::Zero();
    const auto visit = [&](std::uint32_t item) {
      const Vec3 separation = probe.apart(item);
      const double distance = separation.norm();
      work.add(Work::kPair);
      if (distance < nearest) {
        nearest = distance;
        apart = separation;
      }
      return nearest > limits::kPlaneReaches * renewal.room_m;
    };
    const auto bound = [&](const Box& box) { return probe.bound(box); };
    const auto walked = items_.walk(bound, nearest, visit, work, entry);
    return walked.whole && make_plane(at, apart, probe, entry, posed, renewal, work);
  }

  /// The same for a given vector. Fails if the plane leaves less room than `room_m` requires, or if
  /// an item above it is within kPlaneReaches * `need_m`.
  bool make_plane(std::uint32_t at, const Vec3& apart, const Probe& probe,
                  const BoxTree::Entry& entry, const PosedPoints& posed, const Renewal& renewal,
                  Work& work) noexcept {
    const double distance = apart.norm(), least = limits::kPlaneReaches * renewal.room_m;
    if (!(distance > least))
      return false;
    const Vec3 n = apart / distance;
    const double low = lowest(at, n, posed, work);
    const double room = low - (probe.lowest(n) - distance);
    if (!(room > least))
      return false;
    const double height = low - std::max(least, 0.5 * room);
    const double spread = tree_.nodes()[at].spread_m;
    const double near = limits::kPlaneReaches * renewal.need_m;
    double range = plane_range(renewal.need_m);
    const auto visit = [&](std::uint32_t item) {
      work.add(1);
      if (Probe::highest(object_, item, n) <= height)
        return true;
      work.add(Work::kPair);
      range = std::min(range, probe.apart(item).norm() - spread);
      return range > near;
    };
    const auto bound = [&](const Box& box) {
      const double top = n.dot(box.centre()) + 0.5 * n.cwiseAbs().dot(box.high - box.low);
      return top <= height ? kInfinity : probe.bound(box) - spread;
    };
    const auto walked = items_.walk(bound, range, visit, work, entry);
    const double beyond = std::min(range, walked.beyond_m);
    if (!walked.whole || !(beyond > near))
      return false;
    planes_[at] = {n, height, renewal.path_m + beyond, -kInfinity, planes_[at].retry_away_m};
    keep_until(at, renewal.path_m + std::min(low - height, beyond));
    return true;
  }

  /// Lists the pairs of the leaf within `radius_m`, halved until they fit. Adds farther ones within
  /// kListRangeM, up to kListedPairs in all. `plane`: prefers a plane to a list.
  void renew_leaf(std::uint32_t at, const BoxTree::Entry& entry, bool plane, PosedPoints& posed,
                  const Renewal& renewal, Work& work) noexcept {
    const std::uint32_t element = tree_.nodes()[at].element;
    State& state = states_[at];
    const Probe probe(tool_, object_, posed, element);
    const auto rotation_bound = rotation_bound_of(at, posed);
    const auto bound = [&](const Box& box) { return probe.bound(box); };
    const auto nearer = [](const Pair& a, const Pair& b) { return a.touches_m < b.touches_m; };
    double radius = renewal.radius_m;
    for (;; radius *= 0.5) {
      scratch_.clear();
      double range = std::max(radius, radius < renewal.radius_m ? 0.0 : limits::kListRangeM);
      double beyond = kInfinity;
      bool fits = true;
      const auto list = [&](std::uint32_t item) {
        const Vec3 separation = probe.apart(item);
        const double distance = separation.norm();
        work.add(Work::kPair);
        if (distance > range) {
          beyond = std::min(beyond, distance);
          return true;
        }
        fits = scratch_.size() < scratch_.capacity();
        if (!fits)
          return false;
        scratch_.push_back({renewal.path_m + distance, item, separation});
        std::push_heap(scratch_.begin(), scratch_.end(), nearer);
        while (scratch_.size() > limits::kListedPairs &&
               scratch_.front().touches_m > renewal.path_m + radius) {
          range = scratch_.front().touches_m - renewal.path_m;
          beyond = range;
          std::pop_heap(scratch_.begin(), scratch_.end(), nearer);
          scratch_.pop_back();
        }
        return true;
      };
      const auto walked = items_.walk(bound, range, list, work, entry);
      if (walked.whole) {
        const auto first = std::min_element(scratch_.begin(), scratch_.end(), nearer);
        if (plane && first != scratch_.end() &&
            make_plane(at, first->apart, probe, entry, posed, renewal, work))
          return;
        for (Pair& pair : scratch_)
          pair.touches_m = renewal.path_m + touches_after(pair.touches_m - renewal.path_m,
                                                          kInfinity, rotation_bound, pair.item);
        if (store(element, renewal.path_m, work)) {
          state.until_m = renewal.path_m + std::min({beyond, range, walked.beyond_m});
          state.rotation_until_m = kInfinity;
          state.nearest_m = kInfinity;
          for (const Pair& pair : scratch_)
            state.nearest_m = std::min(state.nearest_m, pair.touches_m);
          return;
        }
      }
      const bool too_many = !fits || walked.whole;
      if (!too_many || radius < limits::kMarginM || work.done())
        return;  // keeps the present list
    }
  }

  /// The plane at `item`, across the shortest vector `apart` from it to an element.
  SeparatingPlane plane_between(std::uint32_t item, const Vec3& apart) const noexcept {
    const double distance = apart.norm();
    const Vec3 normal = distance > 0.0 ? Vec3(apart / distance) : Vec3::Zero();
    return {normal, Probe::highest(object_, item, normal)};
  }

  /// Makes `scratch_` the list of `element`. Returns false if there is no room for it, even without
  /// the expired lists.
  bool store(std::uint32_t element, double path_m, Work& work) noexcept {
    if (!store_.has_room(scratch_.size(), element)) {
      work.add(states_.size() / 16);
      release_expired(path_m);
      if (!store_.has_room(scratch_.size(), element))
        return false;
    }
    store_.replace(element, scratch_.size(), [&](Block& block, std::size_t k, std::size_t n) {
      const Pair& pair = scratch_[n];
      block.touches_m[k] = pair.touches_m;
      block.items[k] = pair.item;
      block.planes[k] = plane_between(pair.item, pair.apart);
    });
    return true;
  }

  /// Discards the lists of expired leaves. A valid leaf keeps its list even if its parent is far
  /// from the object, because it counts as complete later.
  void release_expired(double path_m) noexcept {
    for (std::size_t at = 0; at < states_.size(); ++at) {
      const ElementTree::Node& node = tree_.nodes()[at];
      if (!node.leaf || states_[at].until_m > path_m)
        continue;
      store_.clear(node.element);
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
    const auto rotation_bound = rotation_bound_of(at, posed);
    bool whole = true;
    state.nearest_m = kInfinity;
    store_.for_blocks(node.element, [&](Block& block) {
      for (std::size_t k = 0; k < block.count; ++k) {
        double& touches = block.touches_m[k];
        if (whole && touches <= path_m + reach_m) {
          SeparatingPlane& plane = block.planes[k];
          double distance = probe.lowest(plane.normal) - plane.height_m;
          work.add(1);
          if (distance <= reach_m) {
            const Vec3 separation = probe.apart(block.items[k]);
            distance = touches_after(separation.norm(), reach_m, rotation_bound, block.items[k]);
            work.add(Work::kPair);
            plane = plane_between(block.items[k], separation);
          }
          touches = path_m + distance;
          if (distance <= reach_m)
            whole = visit(node.element, block.items[k], distance, plane);
        }
        state.nearest_m = std::min(state.nearest_m, touches);
      }
    });
    return whole;
  }

  /// Whether the node is above its plane at both ends of a straight step, and thus all along it.
  /// `end_m`: path at its end.
  bool stays_above(std::uint32_t at, double end_m, const PosedPoints& posed,
                   const PosedPoints& next, Work& work) const noexcept {
    const Plane& plane = planes_[at];
    return plane.until_m >= end_m &&
           lowest(at, plane.normal, posed, work) > plane.height_m + limits::kTouchM &&
           lowest(at, plane.normal, next, work) > plane.height_m + limits::kMarginM;
  }

  StepVerdict check_node(std::uint32_t at, PosedPoints& posed, PosedPoints& next, const Step& step,
                         Work& work) noexcept {
    const State& state = states_[at];
    const double end = step.path_m + step.length_m;
    if (state.holds(step.path_m, step.rotation_m, step.length_m) && state.nearest_m >= end)
      return StepVerdict::kClear;
    if (work.done())
      return StepVerdict::kUnknown;
    if (stays_above(at, end, posed, next, work))
      return StepVerdict::kClear;
    const ElementTree::Node& node = tree_.nodes()[at];
    const Renewal renewal{step.path_m, step.rotation_m, step.length_m,
                          limits::kListReaches * step.length_m + limits::kListRestM,
                          limits::kMinReachM};
    if (!node.leaf) {
      BoxTree::Entry entry;
      if (std::max(states_[at + 1].until_m, states_[node.next].until_m) < end) {
        if (is_far(at, entry, posed, step.path_m, step.length_m, work))
          return StepVerdict::kClear;
        if (std::isfinite(node.spread_m) && find_plane(at, entry, posed, renewal, work) &&
            stays_above(at, end, posed, next, work))
          return StepVerdict::kClear;
        if (faces_away(at, entry, posed, renewal, work))
          return StepVerdict::kClear;
      }
      const StepVerdict first = check_node(at + 1, posed, next, step, work);
      return first == StepVerdict::kClear ? check_node(node.next, posed, next, step, work) : first;
    }
    const auto holds = [&] { return state.holds(step.path_m, step.rotation_m, step.length_m); };
    if (!holds()) {
      renew_leaf(at, {}, true, posed, renewal, work);
      if (stays_above(at, end, posed, next, work))
        return StepVerdict::kClear;
      if (!holds())
        renew_leaf(at, {}, false, posed, renewal, work);
      if (!holds())
        return StepVerdict::kUnknown;
      if (state.nearest_m >= end)
        return StepVerdict::kClear;
    }
    return check_leaf(node.element, posed, next, step, work);
  }

  /// `check_step` for the listed pairs of one element.
  StepVerdict check_leaf(std::uint32_t element, PosedPoints& posed, PosedPoints& next,
                         const Step& step, Work& work) noexcept {
    const Probe probe(tool_, object_, posed, element), then(tool_, object_, next, element);
    bool may_touch = false;
    store_.for_blocks(element, [&](Block& block) {
      if (may_touch)
        return;
      work.add(1);
      for (std::size_t k = 0; k < block.count; ++k) {
        double& touches = block.touches_m[k];
        if (touches > step.path_m + step.length_m)
          continue;
        SeparatingPlane& plane = block.planes[k];
        const auto stays = [&] {
          work.add(1);
          return probe.lowest(plane.normal) > plane.height_m &&
                 then.lowest(plane.normal) > plane.height_m + limits::kMarginM;
        };
        if (stays())
          continue;
        const Vec3 separation = probe.apart(block.items[k]);
        work.add(Work::kPair);
        plane = plane_between(block.items[k], separation);
        const double distance = separation.norm();
        touches = step.path_m + distance;
        may_touch = distance > step.seen_m && distance <= step.length_m && !stays();
        if (may_touch)
          return;
      }
    });
    return may_touch ? StepVerdict::kMayTouch : StepVerdict::kClear;
  }

  const ToolBody& tool_;
  const ObjectBody& object_;
  const ElementTree& tree_;
  const BoxTree& items_;
  std::vector<State> states_;  ///< of each node
  std::vector<Plane> planes_;  ///< of each node
  PairStore store_;
  std::vector<Pair> scratch_;
};

}  // namespace voxtouch::exact

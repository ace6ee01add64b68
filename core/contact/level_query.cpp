#include "core/contact/level_query.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace voxtouch::contact {
namespace {

constexpr std::size_t kRun = SphereTree::kLeafPoints;
static_assert(kRun == pointshell::ShellLevels::kRun);
constexpr double kForLevels = 0.75;  ///< of the limit; the rest is for contacts that are kept
constexpr double kFade =
    0.25;  ///< a level has all of its share where so much more than its points would fit

void lower(double& weight, double by) noexcept { weight = std::max(0.0, weight - by); }

}  // namespace

LevelQuery::LevelQuery(const pointshell::Pointshell& shell, pointshell::ShellLevels levels,
                       const std::vector<double>& weight)
    : levels_(std::move(levels)) {
  if (levels_.empty())
    return;
  if (levels_.count() > Asked::kMax || levels_.ends.back() != shell.size() ||
      levels_.stands_in.size() != shell.size())
    throw std::invalid_argument(
        "contact: the levels are not those of this pointshell; arrange it once more");
  std::size_t first = 0;
  for (const std::uint32_t end : levels_.ends) {
    if (first % kRun != 0)
      throw std::invalid_argument(
          "contact: a level of the pointshell ends within a leaf of the tree");
    trees_.emplace_back(shell, first, end);
    first = end;
  }
  weights_ =
      level_weights(levels_, weight.empty() ? std::vector<double>(shell.size(), 1.0) : weight);
}

std::size_t LevelQuery::level_of(std::uint32_t point) const noexcept {
  return static_cast<std::size_t>(
      std::upper_bound(levels_.ends.begin(), levels_.ends.end(), point) - levels_.ends.begin());
}

/// What its finest level had goes to the one before it.
void LevelQuery::Asked::drop_last() noexcept {
  share[last] = 0.0;
  --last;
  solid = std::min(solid, last);
}

LevelQuery::Asked LevelQuery::walk(const QueryData& data, const QueryFrame& frame, double limit,
                                   LevelWork& work) const noexcept {
  Asked out;
  std::size_t leaves = 0, points = 0;
  for (std::size_t k = 0; k < levels_.count(); ++k) {
    // The coarsest is asked whatever it costs.
    const std::size_t left =
        k == 0 ? std::numeric_limits<std::size_t>::max() : static_cast<std::size_t>(limit) - points;
    const auto first_leaf = static_cast<std::uint32_t>(k == 0 ? 0 : levels_.ends[k - 1] / kRun);
    const NearLeaves near =
        near_leaves(data, frame, trees_[k], first_leaf, left, work.leaves.data() + leaves);
    if (near.too_many)
      break;
    leaves += near.count, points += near.work;
    const double plenty = limit / static_cast<double>(std::max<std::size_t>(points, 1));
    const double share =
        k == 0 ? 1.0 : out.share[k - 1] * std::clamp((plenty - 1.0) / kFade, 0.0, 1.0);
    if (!(share > 0.0))
      break;
    out.share[k] = share, out.leaves[k] = leaves, out.work[k] = points;
    out.last = k;
    if (share == 1.0)
      out.solid = k;
    if (static_cast<double>(points) >= limit)
      break;
  }
  return out;
}

LevelChoice LevelQuery::choose(const QueryData& data, const QueryFrame& frame,
                               const PointLimit& limit, LevelWork& work) const noexcept {
  Asked asked = walk(data, frame, kForLevels * limit.most, work);
  LevelChoice out;
  if (asked.solid + 1 == levels_.count()) {
    out.leaves = {work.leaves.data(), asked.leaves[asked.last]};
    out.asked_end = levels_.ends.back();
    return out;
  }
  std::size_t kept = 0, raised = 0;
  while (limit.before != nullptr) {
    const std::size_t room =
        limit.most > asked.work[asked.last] ? (limit.most - asked.work[asked.last]) / kRun : 0;
    if (keep(*limit.before, asked, room, work, kept, raised) || asked.last == 0)
      break;
    asked.drop_last();
  }
  weigh(asked, kept, raised, work);
  out.leaves = {work.leaves.data(), asked.leaves[asked.last] + kept};
  out.weights = work.weights.data();
  out.asked_end = levels_.ends[asked.last];
  const std::size_t all = levels_.ends.back(), told = out.asked_end + kRun * kept;
  out.left_out = {static_cast<std::uint32_t>(all > told ? all - told : 0),
                  levels_.covering_m[asked.last]};
  return out;
}

/// Which leaves hold contacts that nobody else would feel. False where there is no room for one of
/// each.
bool LevelQuery::keep(const TouchedPoints& before, const Asked& asked, std::size_t room,
                      LevelWork& work, std::size_t& kept, std::size_t& raised) const noexcept {
  if (++work.now == 0) {
    std::fill(work.leaf_marks.begin(), work.leaf_marks.end(), 0);
    std::fill(work.cell_marks.begin(), work.cell_marks.end(), 0);
    work.now = 1;
  }
  kept = raised = 0;
  const std::uint32_t solid_end = levels_.ends[asked.solid], asked_end = levels_.ends[asked.last];
  std::uint32_t* const leaves = work.leaves.data() + asked.leaves[asked.last];
  bool fits = true;
  for (const bool one_each : {true, false})
    for (const std::span<const std::uint32_t> points : {before.interior(), before.surface()})
      for (auto at = std::lower_bound(points.begin(), points.end(), solid_end); at != points.end();
           ++at) {
        const std::uint32_t leaf = *at / kRun;
        if (work.leaf_marks[leaf] == work.now)
          continue;
        std::uint32_t whose = *at;
        while (whose >= solid_end)
          whose = levels_.stands_in[whose];
        if (before.has(whose) || (one_each && work.cell_marks[whose] == work.now))
          continue;
        if (*at < asked_end) {
          work.raised[raised++] = leaf;
        } else if (kept < room) {
          leaves[kept++] = leaf;
        } else {
          fits = fits && !one_each;
          continue;
        }
        work.leaf_marks[leaf] = work.cell_marks[whose] = work.now;
      }
  std::sort(leaves, leaves + kept);
  return fits;
}

/// What a point of `level` weighs in the levels that are asked.
double LevelQuery::mixed_weight(const Asked& asked, std::size_t level,
                                std::size_t point) const noexcept {
  double weight = 0.0;
  for (std::size_t k = std::max(level, asked.solid); k <= asked.last; ++k)
    weight += asked.part(k) * weights_[k][point];
  return weight;
}

/// What the points of all leaves weigh.
void LevelQuery::weigh(const Asked& asked, std::size_t kept, std::size_t raised,
                       LevelWork& work) const noexcept {
  const std::size_t size = levels_.ends.back();
  const auto end_of = [size](std::size_t leaf) { return std::min(size, kRun * (leaf + 1)); };
  std::size_t level = 0;
  for (std::size_t n = 0; n < asked.leaves[asked.last]; ++n) {
    const std::size_t leaf = work.leaves[n];
    while (kRun * leaf >= levels_.ends[level])
      ++level;
    for (std::size_t p = kRun * leaf; p < end_of(leaf); ++p)
      work.weights[p] = mixed_weight(asked, level, p);
  }
  // Kept points weigh what their own level gives them. All are raised before what they have more is
  // taken from others.
  const std::uint32_t* const leaves = work.leaves.data() + asked.leaves[asked.last];
  const auto for_kept = [&](auto&& f) {
    for (std::size_t n = 0; n < raised + kept; ++n) {
      const std::size_t leaf = n < raised ? work.raised[n] : leaves[n - raised];
      const std::size_t own = level_of(static_cast<std::uint32_t>(kRun * leaf));
      for (std::size_t p = kRun * leaf; p < end_of(leaf); ++p)
        f(p, own <= asked.last ? 1.0 - asked.share[own] : 1.0, weights_[own][p]);
    }
  };
  for_kept([&](std::size_t p, double share, double own) {
    work.weights[p] = share < 1.0 ? work.weights[p] + share * own : own;
  });
  for_kept([&](std::size_t p, double share, double own) {
    take_from_ancestors(asked, static_cast<std::uint32_t>(p), share, own, work);
  });
}

/// Takes `share` of a kept point's weight from those that have it at the levels asked: at each the
/// one that stands for it, or a kept one between the two.
void LevelQuery::take_from_ancestors(const Asked& asked, std::uint32_t point, double share,
                                     double weight, LevelWork& work) const noexcept {
  const std::uint32_t solid_end = levels_.ends[asked.solid], asked_end = levels_.ends[asked.last];
  for (std::uint32_t whose = levels_.stands_in[point];; whose = levels_.stands_in[whose]) {
    const bool is_kept = work.leaf_marks[whose / kRun] == work.now;
    if (whose >= asked_end && !is_kept)
      continue;
    if (is_kept || whose < solid_end)
      return lower(work.weights[whose], share * weight);
    const double before = 1.0 - asked.share[level_of(whose)];  // of levels that do not have it
    lower(work.weights[whose], (share - before) * weight);
    share = before;
  }
}

}  // namespace voxtouch::contact

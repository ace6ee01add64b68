#include "core/pointshell/shell_levels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace voxtouch::pointshell {
namespace {

constexpr double kGrowth = 1.1447142425533319;  ///< of a cell's edge: half of its volume more
constexpr std::size_t kFewer = 3,
                      kOf = 2;  ///< a level has at most 2/3 of the points of the one before it

Vec3 lowest(const Pointshell& shell) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t p = 0; p < shell.size(); ++p)
    low = low.cwiseMin(shell.point(p));
  return low;
}

/// Which of the six sides a normal points to: 2 axis + (1 where it is below zero).
std::uint64_t side_of(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * static_cast<std::uint64_t>(axis) + (normal[axis] < 0.0 ? 1 : 0);
}

/// A point on its way to be kept or left out.
struct Candidate {
  std::uint64_t cell = 0;    ///< cell and side
  double from_middle = 0.0;  ///< of the cell, squared [m^2]
  std::uint32_t point = 0;
};

std::vector<Candidate> in_cells(const Pointshell& shell, const std::vector<std::uint32_t>& points,
                                const Vec3& low, double edge) {
  constexpr double kMaxCells =
      1 << 20;  // along an axis, so that three of them and a side fit a number
  std::vector<Candidate> out;
  out.reserve(points.size());
  for (const std::uint32_t p : points) {
    const Vec3 from = shell.point(p) - low;
    Candidate c{.cell = side_of(shell.normal(p)), .from_middle = 0.0, .point = p};
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::min(std::floor(from[axis] / edge), kMaxCells - 1.0),
                   off = from[axis] - (at + 0.5) * edge;
      c.cell = c.cell << 20 | static_cast<std::uint64_t>(at);
      c.from_middle += off * off;
    }
    out.push_back(c);
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.cell, a.from_middle, a.point) < std::tie(b.cell, b.from_middle, b.point);
  });
  return out;
}

/// One step coarser: who stays, ascending, and of everybody else who stands in.
struct Step {
  std::vector<std::uint32_t> kept, left_out;
};

Step thinned(const std::vector<Candidate>& sorted, std::vector<std::uint32_t>& stands_in) {
  Step step;
  for (std::size_t n = 0; n < sorted.size(); ++n) {
    if (n == 0 || sorted[n].cell != sorted[n - 1].cell) {
      step.kept.push_back(sorted[n].point);
    } else {
      stands_in[sorted[n].point] = step.kept.back();
      step.left_out.push_back(sorted[n].point);
    }
  }
  std::sort(step.kept.begin(), step.kept.end());
  std::sort(step.left_out.begin(), step.left_out.end());
  // Up to a whole run: the first of those that were to go.
  const std::size_t more =
      std::min((ShellLevels::kRun - step.kept.size() % ShellLevels::kRun) % ShellLevels::kRun,
               step.left_out.size());
  for (std::size_t n = 0; n < more; ++n)
    stands_in[step.left_out[n]] = step.left_out[n];
  step.kept.insert(step.kept.end(), step.left_out.begin(),
                   step.left_out.begin() + static_cast<std::ptrdiff_t>(more));
  step.left_out.erase(step.left_out.begin(),
                      step.left_out.begin() + static_cast<std::ptrdiff_t>(more));
  std::sort(step.kept.begin(), step.kept.end());
  return step;
}

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> out;
  out.reserve(values.size());
  for (const std::uint32_t p : order)
    out.push_back(values[p]);
  values = std::move(out);
}

}  // namespace

std::size_t ShellLevels::bytes() const noexcept {
  const std::size_t all = std::accumulate(ends.begin(), ends.end(), std::size_t{0});
  return stands_in.size() * sizeof(std::uint32_t) + all * sizeof(double);
}

ShellLevels arrange_in_levels(Pointshell& shell, std::size_t coarsest) {
  if (coarsest < ShellLevels::kRun)
    throw std::invalid_argument(
        "pointshell: the coarsest level must have room for a run of points");
  ShellLevels levels;
  if (shell.size() <= coarsest)
    return levels;
  const auto size = static_cast<std::uint32_t>(shell.size());
  std::vector<std::uint32_t> alive(size), root(size), stands_in(size);
  std::iota(alive.begin(), alive.end(), 0U);
  root = stands_in = alive;
  std::vector<std::vector<std::uint32_t>> beyond;  // of each step, the finest first
  std::vector<double> covering{0.0};
  const Vec3 low = lowest(shell);
  for (double edge = kGrowth * shell.edge; alive.size() > coarsest; edge *= kGrowth) {
    std::vector<std::uint32_t> stand = stands_in;
    Step step = thinned(in_cells(shell, alive, low, edge), stand);
    if (kFewer * step.kept.size() > kOf * alive.size() && step.kept.size() > coarsest)
      continue;
    if (step.left_out.empty())
      continue;
    stands_in = std::move(stand);
    double farthest = 0.0;
    for (std::uint32_t p = 0; p < size; ++p) {
      root[p] = stands_in[root[p]];
      farthest = std::max(farthest, (shell.point(p) - shell.point(root[p])).norm());
    }
    covering.push_back(farthest);
    beyond.push_back(std::move(step.left_out));
    alive = std::move(step.kept);
  }

  std::vector<std::uint32_t> order = alive;
  levels.ends.push_back(static_cast<std::uint32_t>(order.size()));
  for (auto step = beyond.rbegin(); step != beyond.rend(); ++step) {
    order.insert(order.end(), step->begin(), step->end());
    levels.ends.push_back(static_cast<std::uint32_t>(order.size()));
  }
  levels.covering_m.assign(covering.rbegin(), covering.rend());
  std::vector<std::uint32_t> place(size);
  for (std::uint32_t n = 0; n < size; ++n)
    place[order[n]] = n;
  levels.stands_in.resize(size);
  for (std::uint32_t n = 0; n < size; ++n)
    levels.stands_in[n] = n < levels.ends.front() ? n : place[stands_in[order[n]]];
  for (auto* column : {&shell.x, &shell.y, &shell.z, &shell.nx, &shell.ny, &shell.nz,
                       &shell.area_m2, &shell.coherence})
    reorder(*column, order);
  reorder(shell.id, order);
  return levels;
}

std::vector<std::vector<double>> level_weights(const ShellLevels& levels,
                                               const std::vector<double>& weight) {
  std::vector<std::vector<double>> out(levels.count());
  std::vector<double> now = weight;
  for (std::size_t k = levels.count(); k-- > 0;) {
    for (std::size_t p = levels.ends[k]; p < now.size(); ++p)
      now[levels.stands_in[p]] += now[p];
    now.resize(levels.ends[k]);
    out[k] = now;
  }
  return out;
}

}  // namespace voxtouch::pointshell

#include "core/coupling/design/multiplier.hpp"

#include <coin/Clp_C_Interface.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

namespace voxtouch::coupling::design {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr int kReach = Multiplier::kReach;

/// Smallest M(1) of a searched multiplier, whose weights and M(1) sum to 1.
constexpr double kLeastAtRest = 1e-7;

/// 1 - e^{-j i angle}, without cancellation.
Complex one_less_delay(int i, double angle) {
  const double half = 0.5 * i * angle;
  const double sine = std::sin(half);
  return 2.0 * sine * Complex(sine, std::cos(half));
}

Complex value_at(const Multiplier& m, double angle) {
  Complex sum = m.at_rest;
  for (int i = 1; i <= kReach; ++i) {
    const auto at = static_cast<std::size_t>(i - 1);
    sum += m.past[at] * one_less_delay(i, angle) + m.future[at] * one_less_delay(-i, angle);
  }
  return sum;
}

/// M over an arc: real part at_rest + sum weight (1 - cos i a), imaginary part sum weight sin i a.
CircleValue over_arc(const Multiplier& m, const Arc& arc) {
  CircleValue sum = arc.constant(m.at_rest);
  for (int i = 1; i <= kReach; ++i) {
    const auto at = static_cast<std::size_t>(i - 1);
    const double both = m.past[at] + m.future[at];
    if (!(both > 0.0))
      continue;
    const CircleValue delay = arc.delay(i);
    const double sine = std::sin(0.5 * i * arc.middle());
    const TaylorModel risen{2.0 * sine * sine, -delay.even.slope, delay.even.rest};  // 1 - cos i a
    sum.even = sum.even + both * risen;
    sum.odd = sum.odd - (m.past[at] - m.future[at]) * delay.odd;
  }
  return sum;
}

/// Re{M (1/K + L)} - floor |M|, times the squared modulus of L's denominator.
TaylorModel above_floor(const CircleValue& m, const ContactLoop& one, const Arc& arc) {
  const LoopFraction loop = one.loop(arc);
  const CircleValue conjugate{loop.denominator.even, -1.0 * loop.denominator.odd};
  const CircleValue turned = arc.times(arc.times(m, loop.numerator), conjugate);
  // For a denominator (z - 1) d: conj(z - 1) = -s (s/2 + j cos(a/2)). The common factor s^2 of all
  // terms is dropped.
  const TaylorModel of_loop =
      loop.integrates ? arc.times(arc.half_cosine(), turned.odd) - 0.5 * turned.even : turned.even;
  // |M| <= (|M|^2/c + c)/2 for any c > 0, with equality for c = |M|; c is |M| at the middle of the
  // arc.
  const double c = std::abs(arc.at_middle(m));
  const TaylorModel most = 0.5 / c * arc.norm(m) + 0.5 * c;
  return of_loop +
         arc.times(one.compliance * m.even - one.floor * most, arc.norm(loop.denominator));
}

class Proof {
 public:
  Proof(const Multiplier& m, std::span<const ContactLoop> loops)
      : m_(m),
        loops_(loops),
        is_refuted_(loops.size(), 0) {}

  MultiplierProof run() {
    std::vector<std::size_t> all(loops_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    divide(0.5 * kPi, 0.5 * kPi, all);
    out_.is_multiplier = true;
    return std::move(out_);
  }

 private:
  /// Proves the loops `open` on one arc. Loops that are not proven there are tried on its halves.
  void divide(double middle, double half, const std::vector<std::size_t>& open) {
    constexpr double kShortest = 1e-7;
    const Arc arc(middle, half);
    const CircleValue m = over_arc(m_, arc);
    std::vector<std::size_t> left;
    for (const std::size_t i : open) {
      if (is_refuted_[i])
        continue;
      const TaylorModel f = above_floor(m, loops_[i], arc);
      if (least(f, half) > 0.0)
        continue;
      if (f.value > 0.0 && half > kShortest * middle) {
        left.push_back(i);
        continue;
      }
      out_.refuted.push_back({i, middle});
      is_refuted_[i] = 1;
    }
    if (left.empty())
      return;
    divide(middle - 0.5 * half, 0.5 * half, left);
    divide(middle + 0.5 * half, 0.5 * half, left);
  }

  const Multiplier& m_;
  std::span<const ContactLoop> loops_;
  std::vector<char> is_refuted_;
  MultiplierProof out_;
};

bool is_multiplier(const Multiplier& m) {
  const auto allowed = [](double weight) { return weight >= 0.0 && std::isfinite(weight); };
  return m.at_rest > 0.0 && std::isfinite(m.at_rest) && std::ranges::all_of(m.past, allowed) &&
         std::ranges::all_of(m.future, allowed);
}

/// A point of a loop in the linear programme.
struct Sample {
  double angle;
  Complex value;  ///< 1/K + L
  double floor;
};

Sample sample(const ContactLoop& one, double angle) {
  const Arc point(angle, 0.0);
  return {angle, one.compliance + value_in_the_middle(one.loop(point), point), one.floor};
}

/// Angles of the grid: equal ratios while these give the smaller steps, then equal steps. A coarse
/// grid is sufficient, since the proof adds missing angles.
std::vector<double> grid() {
  constexpr double kLowest = 1e-6;
  constexpr double kRatio = 2.0;
  constexpr double kStep = 0.3;
  std::vector<double> angles;
  for (double angle = kLowest; angle < kPi; angle = std::min(kRatio * angle, angle + kStep))
    angles.push_back(angle);
  angles.push_back(kPi);
  return angles;
}

struct Candidate {
  Multiplier multiplier;
  double floors = 0.0;  ///< number of floors that the real part keeps on the samples
};

/// The rows of a dense linear programme.
template <std::size_t kColumns>
class Rows {
 public:
  void add(const std::array<double, kColumns>& row, double least, double most) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      index_.push_back(static_cast<int>(i));
      element_.push_back(row[i]);
    }
    start_.push_back(static_cast<int>(element_.size()));
    least_.push_back(least);
    most_.push_back(most);
  }

  /// The columns >= 0 that satisfy all rows with the largest value of column `aim`; nothing if the
  /// rows are infeasible.
  std::optional<std::array<double, kColumns>> maximise(std::size_t aim) const {
    const std::unique_ptr<Clp_Simplex, void (*)(Clp_Simplex*)> model(Clp_newModel(),
                                                                     Clp_deleteModel);
    Clp_Simplex* const lp = model.get();
    Clp_setLogLevel(lp, 0);
    Clp_resize(lp, 0, static_cast<int>(kColumns));
    std::fill_n(Clp_columnLower(lp), kColumns, 0.0);
    std::fill_n(Clp_columnUpper(lp), kColumns, kUnbounded);
    std::fill_n(Clp_objective(lp), kColumns, 0.0);
    Clp_objective(lp)[aim] = -1.0;  // Clp minimises
    const int rows = static_cast<int>(least_.size());
    Clp_addRows(lp, rows, least_.data(), most_.data(), start_.data(), index_.data(),
                element_.data());
    if (Clp_dual(lp, 0) != 0)
      return std::nullopt;
    std::array<double, kColumns> columns{};
    std::copy_n(Clp_getColSolution(lp), kColumns, columns.begin());
    return columns;
  }

  static constexpr double kUnbounded = std::numeric_limits<double>::max();  ///< Clp's infinity

 private:
  std::vector<double> element_, least_, most_;
  std::vector<int> index_, start_{0};
};

/// Maximises t in Re{M (1/K + L)} >= t floor |M'| over the samples. M' is the previous multiplier,
/// which makes the row linear.
std::optional<Candidate> solve(const std::vector<Sample>& samples, const Multiplier& before) {
  constexpr std::size_t kWeights = 2 * kReach;  // past, then future
  constexpr std::size_t kAtRest = kWeights;     // M(1) above its minimum
  constexpr std::size_t kFloors = kWeights + 1;
  Rows<kWeights + 2> rows;
  std::array<double, kWeights + 2> row{};
  for (const Sample& at : samples) {
    for (int i = 1; i <= kReach; ++i) {
      const auto past = static_cast<std::size_t>(i - 1);
      row[past] = (one_less_delay(i, at.angle) * at.value).real();
      row[past + kReach] = (one_less_delay(-i, at.angle) * at.value).real();
    }
    row[kAtRest] = at.value.real();
    row[kFloors] = -at.floor * std::abs(value_at(before, at.angle));
    double size = 0.0;
    for (const double entry : row)
      size = std::max(size, std::abs(entry));
    for (double& entry : row)
      entry /= size;
    rows.add(row, -kLeastAtRest * row[kAtRest], rows.kUnbounded);
  }
  row.fill(1.0);
  row[kFloors] = 0.0;
  rows.add(row, 1.0 - kLeastAtRest, 1.0 - kLeastAtRest);

  const auto found = rows.maximise(kFloors);
  if (!found)
    return std::nullopt;
  Candidate out;
  for (std::size_t i = 0; i < kReach; ++i) {
    out.multiplier.past[i] = std::max(0.0, (*found)[i]);
    out.multiplier.future[i] = std::max(0.0, (*found)[i + kReach]);
  }
  out.multiplier.at_rest = kLeastAtRest + std::max(0.0, (*found)[kAtRest]);
  out.floors = (*found)[kFloors];
  return out;
}

}  // namespace

MultiplierProof prove(const Multiplier& multiplier, std::span<const ContactLoop> loops) {
  return is_multiplier(multiplier) ? Proof(multiplier, loops).run() : MultiplierProof{};
}

std::optional<Multiplier> find_multiplier(std::span<const ContactLoop> loops) {
  constexpr int kMostRounds = 12;
  std::vector<Sample> samples;
  for (const double angle : grid())
    for (const ContactLoop& one : loops)
      samples.push_back(sample(one, angle));
  Candidate last;
  last.multiplier.at_rest = 1e-3;  // starts from 1 - z^-1, which most loops need at low frequencies
  last.multiplier.past[0] = 1.0;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::optional<Candidate> next = solve(samples, last.multiplier);
    if (!next)
      return std::nullopt;
    if (round > 0 && next->floors < 1.0 && last.floors < 1.0)
      return std::nullopt;
    last = *next;
    const MultiplierProof proof = prove(last.multiplier, loops);
    if (proof.holds())
      return last.multiplier;
    for (const auto& [loop, angle] : proof.refuted)
      samples.push_back(sample(loops[loop], angle));
  }
  return std::nullopt;
}

}  // namespace voxtouch::coupling::design

#include "core/exact/projection.hpp"

#include <cmath>
#include <limits>

#include "core/exact/limits.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kViolatedM = 1e-12;  // rounding of steps up to some metres
constexpr double kDependent2 =
    1e-18;  // squared sine: nearer to the active rows' space a row adds nothing

/// The active rows, with an orthonormal basis of their jacobians: N = Q R.
class ActiveSet {
 public:
  std::size_t size() const noexcept { return count_; }
  std::uint32_t row(std::size_t k) const noexcept { return rows_[k]; }
  double& force(std::size_t k) noexcept { return forces_[k]; }

  /// Splits `jacobian` into N times `projected` and what is orthogonal to N, which is returned.
  Vec6 split(const Vec6& jacobian, Vec6& projected) const noexcept {
    Vec6 rest = jacobian, along = Vec6::Zero();
    for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
      for (Eigen::Index k = 0; k < signed_count(); ++k) {
        const double part = basis_.col(k).dot(rest);
        along[k] += part;
        rest -= part * basis_.col(k);
      }
    }
    projected = along;
    for (Eigen::Index k = signed_count() - 1; k >= 0; --k) {
      for (Eigen::Index j = k + 1; j < signed_count(); ++j)
        projected[k] -= triangle_(k, j) * projected[j];
      projected[k] /= triangle_(k, k);
    }
    return rest;
  }

  void add(std::uint32_t row, const Vec6& jacobian, double force) noexcept {
    Vec6 rest = jacobian, along = Vec6::Zero();
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index k = 0; k < signed_count(); ++k) {
        const double part = basis_.col(k).dot(rest);
        along[k] += part;
        rest -= part * basis_.col(k);
      }
    }
    const double length = rest.norm();
    along[signed_count()] = length;
    triangle_.col(signed_count()) = along;
    basis_.col(signed_count()) = rest / length;
    jacobians_.col(signed_count()) = jacobian;
    rows_[count_] = row;
    forces_[count_] = force;
    ++count_;
  }

  void remove(std::size_t gone) noexcept {
    const ActiveSet old = *this;
    count_ = 0;
    for (std::size_t k = 0; k < old.count_; ++k) {
      if (k == gone)
        continue;
      add(old.rows_[k], old.jacobians_.col(static_cast<Eigen::Index>(k)), old.forces_[k]);
    }
  }

  void report(const Vec6& target, Projection& out) const noexcept {
    out.count = count_;
    out.active = rows_;
    out.forces_m = forces_;
    out.delta = target;
    for (Eigen::Index k = 0; k < signed_count(); ++k) {
      out.delta += forces_[static_cast<std::size_t>(k)] * jacobians_.col(k);
      out.held += basis_.col(k) * basis_.col(k).transpose();
    }
  }

 private:
  Eigen::Index signed_count() const noexcept { return static_cast<Eigen::Index>(count_); }

  std::size_t count_ = 0;
  std::array<std::uint32_t, 6> rows_{};
  std::array<double, 6> forces_{};
  Mat6 basis_ = Mat6::Zero(), triangle_ = Mat6::Zero(), jacobians_ = Mat6::Zero();
};

/// The row that `delta` violates most; rows.size() where none is.
std::size_t most_violated(std::span<const Halfspace> rows, const Vec6& delta,
                          double& missing) noexcept {
  std::size_t worst = rows.size();
  missing = kViolatedM;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double lacks = rows[k].least_m - rows[k].jacobian.dot(delta);
    if (!(lacks > missing))
      continue;
    missing = lacks;
    worst = k;
  }
  return worst;
}

/// Takes row `entering`, which lacks `missing`, into the set, and others out that it makes
/// superfluous; false where no step keeps it together with the others.
bool enter(std::span<const Halfspace> rows, std::size_t entering, double missing, Vec6& delta,
           ActiveSet& active, int& iterations) noexcept {
  const Vec6& jacobian = rows[entering].jacobian;
  double force = 0.0;
  for (; iterations < limits::kMaxIterations; ++iterations) {
    Vec6 projected;
    const Vec6 rest = active.split(jacobian, projected);
    const double rest2 = rest.squaredNorm();
    const bool independent = active.size() < 6 && rest2 > kDependent2 * jacobian.squaredNorm();
    const double full = independent ? missing / rest2 : kUnlimited;
    double partial = kUnlimited;
    std::size_t leaving = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double falls = projected[static_cast<Eigen::Index>(k)];
      if (!(falls > 1e-14) || !(active.force(k) / falls < partial))
        continue;
      partial = active.force(k) / falls;
      leaving = k;
    }
    const double step = std::min(full, partial);
    if (step == kUnlimited)
      return false;
    for (std::size_t k = 0; k < active.size(); ++k)
      active.force(k) =
          std::max(0.0, active.force(k) - step * projected[static_cast<Eigen::Index>(k)]);
    force += step;
    if (independent) {
      delta += step * rest;
      missing -= step * rest2;
    }
    if (full <= partial) {
      active.add(static_cast<std::uint32_t>(entering), jacobian, force);
      ++iterations;
      return true;
    }
    active.remove(leaving);
  }
  return true;
}

}  // namespace

Projection project(std::span<const Halfspace> rows, const Vec6& target, Work& work) noexcept {
  Projection out;
  ActiveSet active;
  Vec6 delta = target;
  const std::uint64_t scan = 1 + Work::kRows16 * (rows.size() / 16);
  for (;;) {
    double missing = 0.0;
    const std::size_t entering = most_violated(rows, delta, missing);
    work.add(scan);
    if (entering == rows.size())
      break;
    if (out.iterations >= limits::kMaxIterations || work.done()) {
      out.converged = false;
      break;
    }
    const int before = out.iterations;
    const bool entered = enter(rows, entering, missing, delta, active, out.iterations);
    work.add(Work::kRowChange * static_cast<std::uint64_t>(out.iterations - before));
    if (!entered) {
      out.feasible = false;
      break;
    }
    active.report(target, out);  // from the forces anew: no rounding adds up
    delta = out.delta;
    out.held.setZero();
  }
  active.report(target, out);
  return out;
}

}  // namespace voxtouch::exact

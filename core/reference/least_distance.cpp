#include "core/reference/least_distance.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cstddef>

namespace voxtouch::reference {
namespace {

using Vec7 = Eigen::Matrix<double, 7, 1>;
using Columns = Eigen::Matrix<double, 7, Eigen::Dynamic>;

constexpr double kSatisfied = 1e-12;     ///< a smaller violation is rounding
constexpr double kContradiction = 1e-9;  ///< a smaller residual means that x is infinite

/// min |E u - f| with u >= 0 (Lawson and Hanson 1974, chapter 23, algorithm NNLS).
class NonNegativeLeastSquares {
 public:
  NonNegativeLeastSquares(const Columns& e, const Vec7& f)
      : e_(e),
        f_(f),
        u_(Eigen::VectorXd::Zero(e.cols())) {}

  bool solve() {
    const Eigen::Index most = 3 * e_.cols() + 50;
    for (Eigen::Index n = 0; n < most; ++n) {
      const Eigen::Index next = most_violated();
      if (next < 0)
        return true;
      passive_.push_back(next);
      while (!step_to_minimum()) {
      }
      if (!has(passive_, next))
        blocked_.push_back(next);  // by rounding: it depends on the others
      else
        blocked_.clear();
    }
    return false;
  }
  const Eigen::VectorXd& u() const { return u_; }
  Vec7 residual() const { return e_ * u_ - f_; }

 private:
  static bool has(const std::vector<Eigen::Index>& list, Eigen::Index k) {
    return std::find(list.begin(), list.end(), k) != list.end();
  }

  Eigen::Index most_violated() const {
    const Eigen::VectorXd w = -(e_.transpose() * residual());
    Eigen::Index best = -1;
    double most = kSatisfied;
    for (Eigen::Index k = 0; k < w.size(); ++k) {
      if (w[k] <= most || has(passive_, k) || has(blocked_, k))
        continue;
      most = w[k];
      best = k;
    }
    return best;
  }

  /// Towards the minimum over the passive columns, until one of them would become negative; that
  /// one leaves. True: the minimum is reached.
  bool step_to_minimum() {
    const std::size_t count = passive_.size();
    Columns chosen(7, static_cast<Eigen::Index>(count));
    for (std::size_t p = 0; p < count; ++p)
      chosen.col(static_cast<Eigen::Index>(p)) = e_.col(passive_[p]);
    const Eigen::VectorXd z = chosen.colPivHouseholderQr().solve(f_);
    double part = 1.0;
    std::size_t leaves = count;
    for (std::size_t p = 0; p < count; ++p) {
      const double now = u_[passive_[p]], then = z[static_cast<Eigen::Index>(p)];
      const double until = now > 0.0 ? now / (now - then) : 0.0;
      if (then > 0.0 || until > part)
        continue;
      part = until;
      leaves = p;
    }
    for (std::size_t p = 0; p < count; ++p)
      u_[passive_[p]] += part * (z[static_cast<Eigen::Index>(p)] - u_[passive_[p]]);
    if (leaves == count)
      return true;
    u_[passive_[leaves]] = 0.0;
    passive_.erase(passive_.begin() + static_cast<std::ptrdiff_t>(leaves));
    return passive_.empty();
  }

  const Columns& e_;
  Vec7 f_;
  Eigen::VectorXd u_;
  std::vector<Eigen::Index> passive_, blocked_;
};

}  // namespace

LeastDistance least_distance(const std::vector<Inequality>& inequalities) {
  LeastDistance out;
  out.multipliers.assign(inequalities.size(), 0.0);
  if (inequalities.empty()) {
    out.solved = true;
    return out;
  }
  Columns e(7, static_cast<Eigen::Index>(inequalities.size()));
  for (std::size_t k = 0; k < inequalities.size(); ++k)
    e.col(static_cast<Eigen::Index>(k)) << inequalities[k].normal, inequalities[k].bound;
  const Vec7 f = Vec7::Unit(6);
  NonNegativeLeastSquares dual(e, f);
  if (!dual.solve())
    return out;
  const Vec7 residual = dual.residual();
  const double square = residual.squaredNorm();
  if (!(square > kContradiction))
    return out;
  out.x = residual.head<6>() / square;
  for (std::size_t k = 0; k < inequalities.size(); ++k)
    out.multipliers[k] = dual.u()[static_cast<Eigen::Index>(k)] / square;
  out.solved = true;
  return out;
}

}  // namespace voxtouch::reference

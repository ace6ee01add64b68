#include "core/coupling/design/sampled_loop.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "core/coupling/design/sampled_plant.hpp"

namespace voxtouch::coupling::design {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Row = Eigen::RowVectorXd;
using Law = LoopController::Law;

/// The matrix of the loop, built row by row. Every present signal is a row vector over the states,
/// and every next state is a sum of signals. States: [x, T v, (f)] | past commands | controller |
/// velocity filter. Efforts are in m/T^2.
class LoopMatrix {
 public:
  LoopMatrix(const LoopPlant& p, const LoopController& c, double contact_stiffness)
      : plant_(sample_plant(p)),
        past_(plant_.whole_delay + (plant_.splits_period() ? 1 : 0)) {
    const Index law_states = c.law == Law::kShapingFilter ? 2 : c.law == Law::kSpringDamper ? 1 : 0;
    const bool damps = c.injected_damping > 0.0;
    const Index estimator = !damps ? 0 : c.velocity_window > 0 ? window_span(c.velocity_window) : 2;
    const Index n = plant_.order + past_ + law_states + estimator;
    next_ = MatrixXd::Zero(n, n);
    const Index law_at = plant_.order + past_, estimator_at = law_at + law_states;
    Row command = -law(p, c, contact_stiffness, law_at);
    const Index difference_at = c.velocity_window > 0 ? estimator_at : estimator_at + 1;
    if (damps)
      command -=
          c.velocity_window > 0 ? window_damper(p, c, estimator_at) : damper(p, c, estimator_at);
    move(command);
    // The state of the estimator is the last difference of the position, not the last position. A
    // purely integrating position is then isolated in the matrix (see without_integrators).
    if (damps)
      next_.row(difference_at) = next_.row(0) - state(0);
  }
  const MatrixXd& matrix() const { return next_; }

 private:
  Row state(Index i) const { return Row::Unit(next_.cols(), i); }

  /// Present effort of the law; fills in the next values of its states.
  Row law(const LoopPlant& p, const LoopController& c, double contact_stiffness, Index at) {
    const double k = contact_stiffness * plant_.effort_unit;
    if (c.law == Law::kDirect)
      return c.gain * k * state(0);
    if (c.law == Law::kSpringDamper)
      return spring_damper(p, c, k, at);
    return shaping_filter(p, c, c.gain * k * state(0), at);
  }

  /// Trapezoid rule on y' = w0 v, v' = w0 (u - y - 2 d v), with u already times K. The state is the
  /// part of the new y and v that is known ahead of the new input:
  ///     z = (1 + g A) X + g B u,   X = (1 - g A)^-1 (z + g B u)
  Row shaping_filter(const LoopPlant& p, const LoopController& c, const Row& u, Index at) {
    const double g = 0.5 * c.w0_rad_per_s * p.period_s, d2g = 2.0 * c.damping_ratio * g;
    const double scale = 1.0 / (1.0 + d2g + g * g);
    const Row ahead = state(at + 1) + g * u;
    const Row y = scale * ((1.0 + d2g) * state(at) + g * ahead);
    const Row v = scale * (ahead - g * state(at));
    next_.row(at) = y + g * v;
    next_.row(at + 1) = -g * y + (1.0 - d2g) * v + g * u;
    return y;
  }

  /// The displacement of the object, (k x + r/T last)/(k + c + r/T), is the state. The effort is k
  /// (x - displacement), in a form without cancellation for a stiff contact.
  Row spring_damper(const LoopPlant& p, const LoopController& c, double k, Index at) {
    const double spring = c.stiffness * plant_.effort_unit,
                 damper = c.damping / p.period_s * plant_.effort_unit;
    const double all = k + spring + damper;
    if (!(all > 0.0))
      return Row::Zero(next_.cols());
    next_.row(at) = (k * state(0) + damper * state(at)) / all;
    return k / all * ((spring + damper) * state(0) - damper * state(at));
  }

  /// Present effort of the injected damping, from the last difference of the position (state at +
  /// 1) and the last velocity (state at).
  Row damper(const LoopPlant& p, const LoopController& c, Index at) {
    const double w = c.velocity_filter_rad_per_s;
    const double fresh = w > 0.0 ? -std::expm1(-w * p.period_s) : 1.0;
    next_.row(at) = (1.0 - fresh) * state(at) + fresh * state(at + 1);
    return c.injected_damping / p.period_s * plant_.effort_unit * next_.row(at);
  }

  /// The same for a window: its states are the last differences, the newest first.
  Row window_damper(const LoopPlant& p, const LoopController& c, Index at) {
    Row sum = Row::Zero(next_.cols());
    for (int ago = 0; ago < window_span(c.velocity_window); ++ago) {
      sum += window_weight(c.velocity_window, ago) * state(at + ago);
      if (ago > 0)
        next_.row(at + ago) = state(at + ago - 1);
    }
    return c.injected_damping / p.period_s * plant_.effort_unit * sum;
  }

  void move(const Row& command) {
    const Index order = plant_.order, whole = plant_.whole_delay;
    const auto of_samples_ago = [&](Index ago) {
      return ago == 0 ? command : state(order + ago - 1);
    };
    const Row newer = of_samples_ago(whole);
    for (Index i = 0; i < order; ++i) {
      next_.row(i).head(order) = plant_.step_less_one.row(i).head(order);
      next_(i, i) += 1.0;
      next_.row(i) += plant_.newer[i] * newer;
      if (plant_.splits_period())
        next_.row(i) += plant_.older[i] * of_samples_ago(whole + 1);
    }
    for (Index i = 0; i < past_; ++i)
      next_.row(order + i) = of_samples_ago(i);
  }

  SampledPlant plant_;
  Index past_;
  MatrixXd next_;
};

/// Removes leading states that depend only on themselves with weight 1 and that no other state
/// depends on. Returns true if there were any.
bool without_integrators(MatrixXd& a) {
  bool any = false;
  while (a.cols() > 0 && a.col(0) == MatrixXd::Identity(a.rows(), 1)) {
    a = a.bottomRightCorner(a.rows() - 1, a.cols() - 1).eval();
    any = true;
  }
  return any;
}

/// Scales the states by powers of two until rows and columns have similar norms (Parlett, Reinsch
/// 1969). Eigen's solver does not, and a stiff contact or a slow filter gives states of very
/// different size. Exact.
void balance(MatrixXd& a) {
  constexpr int kMaxRounds = 100;  // a handful suffices
  bool changed = true;
  for (int round = 0; changed && round < kMaxRounds; ++round) {
    changed = false;
    for (Index i = 0; i < a.rows(); ++i) {
      const double column = a.col(i).cwiseAbs().sum() - std::abs(a(i, i)),
                   row = a.row(i).cwiseAbs().sum() - std::abs(a(i, i));
      if (column == 0.0 || row == 0.0)
        continue;
      const int power = static_cast<int>(std::lround(0.5 * std::log2(row / column)));
      if (power == 0 || std::ldexp(column, power) + std::ldexp(row, -power) > 0.95 * (column + row))
        continue;
      a.col(i) *= std::ldexp(1.0, power);
      a.row(i) *= std::ldexp(1.0, -power);
      changed = true;
    }
  }
}

/// The real solver does not converge for about one loop in 50 000 (four states, two of them past
/// commands). The complex solver is three times slower, uses different shifts and has solved all of
/// these.
Eigen::VectorXcd eigenvalues_of(const MatrixXd& a) {
  const Eigen::EigenSolver<MatrixXd> real(a, false);
  if (real.info() == Eigen::Success)
    return real.eigenvalues();
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> complex(a.cast<std::complex<double>>(), false);
  if (complex.info() != Eigen::Success)
    throw std::runtime_error("The loop's eigenvalues did not converge.");
  return complex.eigenvalues();
}

/// Eigenvalues of the closed loop except those of free integrators; `integrators` returns whether
/// there were any.
Eigen::VectorXcd loop_eigenvalues(const LoopPlant& plant, const LoopController& controller,
                                  double contact_stiffness, bool& integrators) {
  MatrixXd a = LoopMatrix(plant, controller, contact_stiffness).matrix();
  integrators = without_integrators(a);
  if (a.size() == 0)
    return {};
  if (!a.allFinite())
    throw std::invalid_argument("The loop's numbers are out of the range of a double.");
  balance(a);
  return eigenvalues_of(a);
}

}  // namespace

double spectral_radius(const LoopPlant& plant, const LoopController& controller,
                       double contact_stiffness) {
  bool integrators = false;
  const Eigen::VectorXcd all = loop_eigenvalues(plant, controller, contact_stiffness, integrators);
  const double least = integrators ? 1.0 : 0.0;
  return all.size() == 0 ? least : std::max(least, all.cwiseAbs().maxCoeff());
}

double slowest_damping_ratio(const LoopPlant& plant, const LoopController& controller,
                             double contact_stiffness) {
  bool integrators = false;
  std::complex<double> slowest = 0.0;
  for (const std::complex<double>& z :
       loop_eigenvalues(plant, controller, contact_stiffness, integrators))
    if ((z.imag() != 0.0 || z.real() < 0.0) && std::abs(z) > std::abs(slowest))
      slowest = z;
  if (slowest == 0.0)
    return 1.0;
  const std::complex<double> s = std::log(slowest);  // times T
  return -s.real() / std::abs(s);
}

}  // namespace voxtouch::coupling::design

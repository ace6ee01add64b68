#include "core/identification/output_error.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/identification/window_response.hpp"

namespace voxtouch::identification {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int kFewestWindows = 5;
constexpr double kMostDampingRate = 600.0;  // b / m [1/s]
constexpr std::array kModeStartsHz{14.0, 18.0, 22.0, 27.0,  33.0,  40.0,  48.0,
                                   58.0, 70.0, 85.0, 103.0, 125.0, 152.0, 185.0};

/// Quantile 0.975 of Student's t (Cornish-Fisher; within 1 % from 4 degrees of freedom on).
double student_975(double degrees) {
  return 1.96 + 2.372 / degrees + 2.823 / (degrees * degrees) +
         2.556 / (degrees * degrees * degrees);
}

/// The columns of all windows with the local ones projected out.
struct Projected {
  Vector measured;  // R
  Matrix linear;    // columns of the linear parameters: mu, g+, g-, and the mode's amplitude
};

/// Linear parameters at given nonlinear ones.
struct Solved {
  Vector linear;
  double sum_of_squares = std::numeric_limits<double>::infinity();
};

class Problem {
 public:
  Problem(const AxisRecord& record, const std::vector<Window>& windows, const FitOptions& options)
      : options_(options) {
    for (const Window& w : windows) {
      WindowResponse response(record, w, options.most_delay_s, options.spacing_s);
      if (response.samples() < options.fewest_samples)
        continue;
      if (options.friction_known)
        response.set_known_force(options.start.bias_n - w.direction * options.start.coulomb_n);
      responses_.push_back(std::move(response));
      offsets_.push_back(rows_);
      rows_ += static_cast<Eigen::Index>(responses_.back().samples());
      coupled_ = coupled_ || responses_.back().coupled();
      both_ = both_ || responses_.back().direction() != responses_.front().direction();
    }
    offsets_.push_back(rows_);
  }

  std::size_t windows() const { return responses_.size(); }
  Eigen::Index rows() const { return rows_; }
  bool both_directions() const { return both_; }
  Eigen::Index cross_axis_columns() const {
    return coupled_ && !options_.friction_known ? WindowResponse::kCrossAxis : 0;
  }
  const FitOptions& options() const { return options_; }
  Eigen::Index first_row(std::size_t w) const { return offsets_[w]; }
  Eigen::Index row_count(std::size_t w) const { return offsets_[w + 1] - offsets_[w]; }

  Projected project(const Nonlinear& at, bool with_amplitude) const {
    const Eigen::Index forces = options_.friction_known ? 0 : both_ ? 2 : 1;
    const Eigen::Index others = cross_axis_columns();
    const Eigen::Index columns = 1 + forces + others + (with_amplitude ? 1 : 0);
    Projected out{Vector(rows_), Matrix::Zero(rows_, columns)};
    Matrix local;
    for (std::size_t w = 0; w < responses_.size(); ++w) {
      const WindowResponse& response = responses_[w];
      const Eigen::Index first = first_row(w), count = row_count(w);
      auto block = out.linear.middleRows(first, count);
      auto measured = out.measured.segment(first, count);
      measured = response.measured();
      const Eigen::Index direction = both_ && response.direction() < 0 ? 2 : 1;
      Matrix columns_w(count, with_amplitude ? 3 : 2);
      Matrix cross_axis(count, others);
      response.respond(at, columns_w, local, cross_axis);
      if (others > 0)
        block.middleCols(1 + forces, others) = cross_axis;
      block.col(0) = columns_w.col(0);
      if (forces > 0)
        block.col(direction) = columns_w.col(1);
      if (with_amplitude)
        block.col(columns - 1) = columns_w.col(2);
      remove(local, block, measured);
    }
    return out;
  }

  /// Marks commands that were lost, given a fit. Returns how many are new.
  std::size_t find_lost_commands(const Nonlinear& at, const Solved& solved) {
    std::size_t found = 0;
    for (std::size_t w = 0; w < responses_.size(); ++w) {
      // The residual against all commands as they were sent.
      WindowResponse& response = responses_[w];
      response.forget_lost_commands();
      Matrix columns(row_count(w), 2), local;
      Matrix cross_axis(row_count(w), cross_axis_columns());
      response.respond(at, columns, local, cross_axis);
      Vector rest = response.measured() - columns.col(0) * solved.linear[0];
      if (cross_axis.cols() > 0)
        rest -= cross_axis * solved.linear.tail(cross_axis.cols());
      if (!options_.friction_known)
        rest -= columns.col(1) * solved.linear[both_ && response.direction() < 0 ? 2 : 1];
      remove(local, columns, rest);
      found +=
          response.find_lost_commands(at, solved.linear[0], local, rest, options_.encoder_step_m);
    }
    return found;
  }
  std::vector<Curve> curves(const Vector& residual) const {
    std::vector<Curve> out;
    for (std::size_t w = 0; w < responses_.size(); ++w) {
      const WindowResponse& r = responses_[w];
      const Vector rest = residual.segment(first_row(w), row_count(w));
      out.push_back({r.direction(),
                     r.start_s(),
                     r.times_s(),
                     {r.measured().begin(), r.measured().end()},
                     {rest.begin(), rest.end()}});
    }
    return out;
  }
  double lost_ratio() const {
    double lost = 0.0, all = 0.0;
    for (const WindowResponse& r : responses_) {
      lost += static_cast<double>(r.lost_commands());
      all += static_cast<double>(r.commands());
    }
    return all > 0.0 ? lost / all : 0.0;
  }

  static Solved solve(const Projected& p) {
    const Matrix normal = p.linear.transpose() * p.linear;
    const Vector scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Matrix scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    scaled.diagonal().array() += 1e-13;  // a column may be zero: another axis that never moves
    const Vector right = scale.asDiagonal() * (p.linear.transpose() * p.measured);
    Solved out;
    out.linear = scale.asDiagonal() * scaled.ldlt().solve(right);
    out.sum_of_squares = (p.measured - p.linear * out.linear).squaredNorm();
    if (!out.linear.allFinite() || !(out.linear[0] > 0.0) || !std::isfinite(out.sum_of_squares))
      out.sum_of_squares = std::numeric_limits<double>::infinity();
    return out;
  }

  Solved solve_at(const Nonlinear& at, bool with_amplitude) const {
    return solve(project(at, with_amplitude));
  }

 private:
  /// Removes the part of `block` and `measured` that the local columns explain.
  static void remove(Matrix& local, Eigen::Ref<Matrix> block, Eigen::Ref<Vector> measured) {
    for (Eigen::Index c = 0; c < local.cols(); ++c) {
      for (int pass = 0; pass < 2; ++pass)
        for (Eigen::Index before = 0; before < c; ++before)
          local.col(c) -= local.col(before).dot(local.col(c)) * local.col(before);
      const double norm = local.col(c).norm();
      if (norm > 1e-12)
        local.col(c) /= norm;
      else
        local.col(c).setZero();
    }
    for (Eigen::Index c = 0; c < block.cols(); ++c)
      block.col(c) -= local * (local.transpose() * block.col(c)).eval();
    measured -= local * (local.transpose() * measured).eval();
  }

  FitOptions options_;
  std::vector<WindowResponse> responses_;
  std::vector<Eigen::Index> offsets_;
  Eigen::Index rows_ = 0;
  bool both_ = false, coupled_ = false;
};

/// The nonlinear parameters that a fit varies.
struct Varied {
  std::array<double Nonlinear::*, 5> members{&Nonlinear::delay_s, &Nonlinear::damping_rate};
  int count = 2;
};

Varied varied(bool with_lag, bool with_mode) {
  Varied v;
  const auto add = [&](double Nonlinear::*member) {
    v.members[static_cast<std::size_t>(v.count++)] = member;
  };
  if (with_mode) {
    add(&Nonlinear::log_frequency);
    add(&Nonlinear::damping_ratio);
  }
  if (with_lag)
    add(&Nonlinear::lag_s);
  return v;
}

double difference_step(double Nonlinear::*member, const Nonlinear& at) {
  if (member == &Nonlinear::delay_s || member == &Nonlinear::lag_s)
    return 2e-6;
  if (member == &Nonlinear::damping_rate)
    return 1e-3 + 1e-4 * std::abs(at.damping_rate);
  return 1e-4;
}

Nonlinear within_bounds(Nonlinear at, double most_delay_s) {
  at.delay_s = std::clamp(at.delay_s, 0.0, most_delay_s);
  at.lag_s = std::clamp(at.lag_s, 0.0, at.delay_s);
  at.damping_rate = std::clamp(at.damping_rate, -5.0, kMostDampingRate);
  at.log_frequency = std::clamp(at.log_frequency, std::log(8.0), std::log(300.0));
  at.damping_ratio = std::clamp(at.damping_ratio, 1e-3, 0.7);
  return at;
}

/// All derivatives at one point: parameters are the linear ones, then the nonlinear ones.
struct Linearised {
  Solved solved;
  Vector residual;
  Matrix jacobian;  // of the model
};

Linearised linearise(const Problem& problem, const Nonlinear& at, bool with_mode) {
  Linearised out;
  const Projected here = problem.project(at, with_mode);
  out.solved = Problem::solve(here);
  out.residual = here.measured - here.linear * out.solved.linear;
  const Varied v = varied(problem.options().with_lag, with_mode);
  out.jacobian.resize(problem.rows(), here.linear.cols() + v.count);
  out.jacobian.leftCols(here.linear.cols()) = here.linear;
  for (int k = 0; k < v.count; ++k) {
    const auto member = v.members[static_cast<std::size_t>(k)];
    Nonlinear moved = at;
    const double step = difference_step(member, at);
    moved.*member += step;
    const Projected there = problem.project(moved, with_mode);
    const Vector residual = there.measured - there.linear * out.solved.linear;
    out.jacobian.col(here.linear.cols() + k) = (out.residual - residual) / step;
  }
  return out;
}

struct Minimum {
  Nonlinear at;
  Linearised linear;
  bool converged = false;
};

/// Levenberg-Marquardt on the nonlinear parameters; the linear ones are solved at each point.
Minimum minimise(const Problem& problem, Nonlinear at, bool with_mode, double most_delay_s,
                 int iterations = 25) {
  Minimum out;
  at = within_bounds(at, most_delay_s);
  Linearised here = linearise(problem, at, with_mode);
  double damping = 1e-3;
  for (int i = 0; i < iterations && std::isfinite(here.solved.sum_of_squares); ++i) {
    const Matrix h = here.jacobian.transpose() * here.jacobian;
    const Vector s = here.jacobian.transpose() * here.residual;
    const Eigen::Index linear = here.solved.linear.size();
    const Varied v = varied(problem.options().with_lag, with_mode);
    const Vector scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    bool moved = false;
    double relative = 0.0;
    for (int tries = 0; tries < 8 && !moved; ++tries) {
      Matrix damped = scale.asDiagonal() * h * scale.asDiagonal();
      damped.diagonal().array() += 1e-13;
      for (Eigen::Index k = linear; k < damped.cols(); ++k)
        damped(k, k) += damping;
      const Vector step = scale.asDiagonal() * damped.ldlt().solve(scale.asDiagonal() * s);
      if (!step.allFinite())
        break;
      Nonlinear next = at;
      for (int k = 0; k < v.count; ++k)
        next.*v.members[static_cast<std::size_t>(k)] += step[linear + k];
      next = within_bounds(next, most_delay_s);
      const double before = here.solved.sum_of_squares;
      const Solved solved = problem.solve_at(next, with_mode);
      if (solved.sum_of_squares <= before) {
        relative = std::abs(next.delay_s - at.delay_s) / 1e-4 +
                   std::abs(next.damping_rate - at.damping_rate) /
                       (0.1 + 0.1 * std::abs(at.damping_rate)) +
                   (with_mode ? std::abs(next.log_frequency - at.log_frequency) / 0.01 : 0.0);
        at = next;
        moved = true;
        damping = std::max(1e-9, 0.1 * damping);
      } else {
        damping *= 10.0;
      }
    }
    if (!moved) {
      out.converged = true;
      break;
    }
    here = linearise(problem, at, with_mode);
    if (relative < 1e-3) {
      out.converged = true;
      break;
    }
  }
  out.at = at;
  out.linear = std::move(here);
  out.converged = out.converged && std::isfinite(out.linear.solved.sum_of_squares);
  return out;
}

/// Covariance of all parameters by the delete-one-window jackknife (CV3 of MacKinnon et al. 2023).
Matrix jackknife(const Problem& problem, const Linearised& at) {
  const Eigen::Index size = at.jacobian.cols();
  const auto n = static_cast<double>(problem.windows());
  const Matrix h = at.jacobian.transpose() * at.jacobian;
  const Vector scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Matrix deviations(size, static_cast<Eigen::Index>(problem.windows()));
  for (std::size_t w = 0; w < problem.windows(); ++w) {
    const auto j = at.jacobian.middleRows(problem.first_row(w), problem.row_count(w));
    const Vector s =
        j.transpose() * at.residual.segment(problem.first_row(w), problem.row_count(w));
    Matrix rest = scale.asDiagonal() * (h - j.transpose() * j) * scale.asDiagonal();
    rest.diagonal().array() += 1e-13;
    deviations.col(static_cast<Eigen::Index>(w)) =
        scale.asDiagonal() * rest.ldlt().solve(scale.asDiagonal() * s);
  }
  const Vector mean = deviations.rowwise().mean();
  deviations.colwise() -= mean;
  return (n - 1.0) / n * deviations * deviations.transpose();
}

double hypot_of(double a, double b) { return std::sqrt(a * a + b * b); }

/// From the fit's parameters to figures with intervals.
AxisFigures figures_of(const Problem& problem, const Minimum& minimum, const FitOptions& options) {
  AxisFigures f;
  const Vector& linear = minimum.linear.solved.linear;
  const bool both = problem.both_directions();
  const double m = 1.0 / linear[0], beta = minimum.at.damping_rate;
  const bool known = options.friction_known;
  const double plus = known ? 0.0 : linear[1], minus = both && !known ? linear[2] : 0.0;
  const Eigen::Index tau = linear.size(), rate = tau + 1;
  f.mass_kg.value = m;
  f.viscous_ns_per_m.value = beta * m;
  f.delay_s.value = minimum.at.delay_s;
  if (known) {
    f.coulomb_n.value = options.start.coulomb_n;
    f.bias_n.value = options.start.bias_n;
  } else if (both) {
    f.coulomb_n.value = 0.5 * m * (minus - plus);
    f.bias_n.value = 0.5 * m * (minus + plus);
  } else {
    f.bias_n.value = options.start.bias_n;
    f.coulomb_n.value = std::abs(options.start.bias_n - m * plus);
  }
  f.residual_m =
      std::sqrt(minimum.linear.solved.sum_of_squares / static_cast<double>(problem.rows()));
  f.lag_s = minimum.at.lag_s;
  if (known || problem.windows() < kFewestWindows)
    return f;
  const Matrix c = jackknife(problem, minimum.linear);
  const Eigen::Index size = c.rows();
  Matrix to = Matrix::Zero(5, size);  // rows: m, b, Fc, c, tau
  to(0, 0) = -m * m;
  to.row(1) = beta * to.row(0);
  to(1, rate) += m;
  if (both) {
    to.row(2) = 0.5 * (minus - plus) * to.row(0);
    to(2, 2) += 0.5 * m;
    to(2, 1) -= 0.5 * m;
    to.row(3) = 0.5 * (minus + plus) * to.row(0);
    to(3, 2) += 0.5 * m;
    to(3, 1) += 0.5 * m;
  }
  to(4, tau) = 1.0;
  const Matrix physical = to * c * to.transpose();
  const double t = student_975(static_cast<double>(problem.windows()) - 1.0);
  const auto half = [&](int row) { return t * std::sqrt(std::max(0.0, physical(row, row))); };
  const double period = options.longest_period_s;
  // Effects outside the model, in quadrature: lost commands that were not found, presliding, a lag
  // of higher order. Set so that the intervals contain the truth in 95 % of simulated devices. A
  // lost command acts for one period.
  const double per_loss = std::sqrt(period / 1e-3);
  const double friction = std::abs(f.coulomb_n.value);
  f.mass_kg.half_width = hypot_of(half(0), 0.0065 * m * per_loss);
  f.viscous_ns_per_m.half_width = hypot_of(half(1), 0.047 * std::sqrt(m) * per_loss);
  f.coulomb_n.half_width = hypot_of(half(2), std::max(0.5e-3, 0.0022 * friction));
  f.bias_n.half_width = hypot_of(half(3), std::max(0.5e-3, 0.001 * friction));
  f.delay_s.half_width = hypot_of(half(4), std::max(50e-6, 0.05 * period));
  return f;
}

/// Does the mode explain more than its free response alone does, in most windows?
bool mode_is_significant(const Problem& problem, const Minimum& minimum, double& sd_log_frequency) {
  const Projected p = problem.project(minimum.at, true);
  Projected without{p.measured, p.linear.leftCols(p.linear.cols() - 1)};
  const Solved base = Problem::solve(without);
  if (!std::isfinite(base.sum_of_squares))
    return false;
  const Vector before = p.measured - without.linear * base.linear;
  const Vector& after = minimum.linear.residual;
  double sum = 0.0, squares = 0.0;
  const auto n = static_cast<double>(problem.windows());
  for (std::size_t w = 0; w < problem.windows(); ++w) {
    const auto rows = std::pair(problem.first_row(w), problem.row_count(w));
    const double a = before.segment(rows.first, rows.second).squaredNorm();
    const double b = after.segment(rows.first, rows.second).squaredNorm();
    const double gain = (a - b) / (a + b + 1e-300);
    sum += gain;
    squares += gain * gain;
  }
  const double mean = sum / n, variance = std::max(1e-12, squares / n - mean * mean);
  const double t = mean / std::sqrt(variance / (n - 1.0));
  const Matrix c = jackknife(problem, minimum.linear);
  const Eigen::Index amplitude = minimum.linear.solved.linear.size() - 1, frequency = amplitude + 3;
  sd_log_frequency = std::sqrt(std::max(0.0, c(frequency, frequency)));
  const double t_amplitude = std::abs(minimum.linear.solved.linear[amplitude]) /
                             std::sqrt(std::max(1e-300, c(amplitude, amplitude)));
  return t > 3.0 && mean > 0.02 && t_amplitude > 4.0 && sd_log_frequency < 0.02 &&
         minimum.at.damping_ratio < 0.3;
}

/// The best start of a mode: the amplitude is linear, so a grid of frequencies is cheap.
Minimum search_mode(const Problem& problem, const Minimum& rigid, double most_delay_s) {
  struct Start {
    double sum_of_squares;
    Nonlinear at;
  };
  std::vector<Start> starts;
  for (const double f : kModeStartsHz) {
    for (const double damping : {0.03, 0.12}) {
      Nonlinear at = rigid.at;
      at.log_frequency = std::log(f);
      at.damping_ratio = damping;
      starts.push_back({problem.solve_at(at, true).sum_of_squares, at});
    }
  }
  std::ranges::sort(starts, {}, &Start::sum_of_squares);
  Minimum best;
  best.linear.solved.sum_of_squares = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    Minimum found =
        minimise(problem, starts[static_cast<std::size_t>(k)].at, true, most_delay_s, 12);
    if (found.linear.solved.sum_of_squares < best.linear.solved.sum_of_squares)
      best = std::move(found);
  }
  return best;
}

Nonlinear start_of(const Problem& problem, const FitOptions& o) {
  Nonlinear best{.delay_s = o.start.delay_s, .lag_s = o.with_lag ? 0.2 * o.start.delay_s : 0.0};
  if (o.start.mass_kg > 0.0) {
    best.damping_rate = o.start.viscous_ns_per_m / o.start.mass_kg;
    return best;
  }
  double least = std::numeric_limits<double>::infinity();
  for (double delay = 0.3e-3; delay < o.most_delay_s; delay = 1.35 * delay + 0.3e-3) {
    for (const double rate : {0.0, 4.0, 20.0, 100.0}) {
      const Nonlinear at{.delay_s = delay, .damping_rate = rate};
      const double sum = problem.solve_at(at, false).sum_of_squares;
      if (sum < least) {
        least = sum;
        best = at;
      }
    }
  }
  return best;
}

}  // namespace

Fit fit_output_error(const AxisRecord& record, const std::vector<Window>& windows,
                     const FitOptions& options) {
  Fit out;
  Problem problem(record, windows, options);
  out.windows = problem.windows();
  out.samples = static_cast<double>(problem.rows());
  if (problem.windows() < 1)
    return out;
  Minimum rigid = minimise(problem, start_of(problem, options), false, options.most_delay_s);
  for (int pass = 0;
       pass < options.loss_passes && std::isfinite(rigid.linear.solved.sum_of_squares); ++pass) {
    if (problem.find_lost_commands(rigid.at, rigid.linear.solved) == 0)
      break;
    rigid = minimise(problem, rigid.at, false, options.most_delay_s);
  }
  out.converged = rigid.converged;
  const double lost_ratio = problem.lost_ratio();
  if (!rigid.converged)
    return out;
  out.figures = figures_of(problem, rigid, options);
  out.figures.lost_commands = lost_ratio;
  if (options.with_curves)
    out.curves = problem.curves(rigid.linear.residual);
  if (!options.with_mode || problem.windows() < kFewestWindows)
    return out;
  const Minimum mode = search_mode(problem, rigid, options.most_delay_s);
  double sd_log_frequency = 0.0;
  if (!std::isfinite(mode.linear.solved.sum_of_squares))
    return out;
  if (!mode_is_significant(problem, mode, sd_log_frequency))
    return out;
  out.figures = figures_of(problem, mode, options);
  out.figures.lost_commands = lost_ratio;
  if (options.with_curves)
    out.curves = problem.curves(mode.linear.residual);
  const double f = std::exp(mode.at.log_frequency);
  const double t = student_975(static_cast<double>(problem.windows()) - 1.0);
  out.figures.mode = {
      .found = true,
      .frequency_hz = {f, t * sd_log_frequency * f},
      .damping_ratio = mode.at.damping_ratio,
      .mass_ratio = mode.linear.solved.linear[mode.linear.solved.linear.size() - 1] /
                    mode.linear.solved.linear[0]};
  return out;
}

}  // namespace voxtouch::identification

#include "core/identification/start_check.hpp"

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "core/identification/windows.hpp"

namespace voxtouch::identification {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr std::size_t kTones = 12;  // tone k is of axis k mod 3
constexpr std::size_t kOwn = kTones / 3;
constexpr double kFirstHz = 17.0, kApartHz = 4.0;
constexpr double kAcceleration = 0.06;             // [m/s^2] of a tone
constexpr double kLargestForceRatio = 0.01;        // of the device's force, of a tone
constexpr int kSlowCosines = 24, kSlowPowers = 6;  // motion up to 12 Hz
constexpr double kFastestRate = 1.5;               // of the nominal one, for the capacity
constexpr double kDelayStepS = 2e-5;
constexpr std::size_t kDelaySteps = 1000;
constexpr double kSigmas = 3.0;
constexpr double kLeastStrength = 40.0, kMostSum = 40.0, kMostSpringRatio = 0.5;
constexpr double kAgreeingFactor = 1.5;  // ratio up to which measured and filed values agree
constexpr double kPenHandKg = 0.2, kArmHandKg = 2.0;  // that may be at the tool
constexpr std::size_t kMaxReversals = 8;
constexpr double kReversalSteps = 4.0, kReversalM = 5e-5;
constexpr std::size_t kFewestIncrements = 30;

double tone_omega(std::size_t tone) {
  return 2.0 * std::numbers::pi * (kFirstHz + kApartHz * static_cast<double>(tone));
}

/// Amplitudes of all tones of a signal, with slow motion fitted together with them.
class ToneFit {
 public:
  /// `reversals_s`: times at which the motion reverses. Friction then changes its sign, which bends
  /// the path.
  ToneFit(const std::vector<double>& times_s, const std::vector<double>& reversals_s)
      : rows_(times_s.size()) {
    const auto rows = static_cast<Eigen::Index>(rows_);
    constexpr Eigen::Index kFirstReversalColumn = 2 * kTones + kSlowCosines + kSlowPowers;
    basis_.resize(rows, kFirstReversalColumn + 2 * static_cast<Eigen::Index>(reversals_s.size()));
    const double begin = times_s.front(), length = times_s.back() - begin;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double t = times_s[static_cast<std::size_t>(i)], part = (t - begin) / length;
      for (std::size_t k = 0; k < kTones; ++k) {
        const auto column = static_cast<Eigen::Index>(2 * k);
        basis_(i, column) = std::cos(tone_omega(k) * t);
        basis_(i, column + 1) = -std::sin(tone_omega(k) * t);
      }
      for (int k = 0; k < kSlowCosines; ++k)
        basis_(i, 2 * kTones + k) = std::cos(std::numbers::pi * (k + 1) * part);
      double power = 1.0;
      for (int k = 0; k < kSlowPowers; ++k, power *= 2.0 * part - 1.0)
        basis_(i, 2 * kTones + kSlowCosines + k) = power;
      for (std::size_t k = 0; k < reversals_s.size(); ++k) {
        const double since = std::max(0.0, (t - reversals_s[k]) / length);
        const auto column = kFirstReversalColumn + static_cast<Eigen::Index>(2 * k);
        basis_(i, column) = since;
        basis_(i, column + 1) = since * since;
      }
    }
    Matrix normal = basis_.transpose() * basis_;
    normal.diagonal().array() += 1e-9 * static_cast<double>(rows_);
    solver_.compute(normal);
  }

  /// Real part of amplitude * exp(j w t).
  std::array<Complex, kTones> amplitudes(const Vector& signal) const {
    const Vector found = solver_.solve(basis_.transpose() * signal);
    std::array<Complex, kTones> out;
    for (std::size_t k = 0; k < kTones; ++k)
      out[k] = {found[static_cast<Eigen::Index>(2 * k)],
                found[static_cast<Eigen::Index>(2 * k + 1)]};
    return out;
  }

 private:
  std::size_t rows_;
  Matrix basis_;
  Eigen::LDLT<Matrix> solver_;
};

/// Times at which the motion reverses by more than `least_m`.
std::vector<double> reversals_of(const std::vector<double>& times_s, const Vector& position,
                                 double least_m) {
  std::vector<double> out;
  Eigen::Index extreme = 0;
  int direction = 0;
  for (Eigen::Index i = 1; i < position.size() && out.size() < kMaxReversals; ++i) {
    const double moved = position[i] - position[extreme];
    if (direction == 0) {
      if (std::abs(moved) > least_m)
        direction = moved > 0.0 ? 1 : -1;
      else
        continue;
    }
    if (direction * moved >= 0.0) {
      extreme = i;
    } else if (-direction * moved > least_m) {
      out.push_back(times_s[static_cast<std::size_t>(extreme)]);
      direction = -direction;
      extreme = i;
    }
  }
  return out;
}

/// One axis at its tones.
struct Response {
  std::array<Complex, kOwn> position, force;
  std::array<double, kOwn> omega{};
  double noise_m = 0.0;  ///< standard deviation of the real part of a position
};

/// k, m and b at a delay, with the sum of squares in units of the noise.
struct AtDelay {
  Eigen::Vector3d found;
  Eigen::Matrix3d inverse;
  double sum = 0.0;
};

AtDelay solve_at(const Response& r, double delay_s, double hold_s, double usual_mass_kg) {
  Eigen::Matrix<double, 2 * kOwn, 3> rows;
  Eigen::Matrix<double, 2 * kOwn, 1> right;
  for (std::size_t k = 0; k < kOwn; ++k) {
    const double w = r.omega[k];
    const double scale = 1.0 / (usual_mass_kg * w * w * r.noise_m);
    const Complex x = scale * r.position[k];
    const Complex f = scale * r.force[k] * std::polar(1.0, -w * (delay_s + 0.5 * hold_s));
    const std::array columns{x, -w * w * x, Complex(0.0, w) * x};
    const auto row = static_cast<Eigen::Index>(2 * k);
    for (Eigen::Index c = 0; c < 3; ++c) {
      rows(row, c) = columns[static_cast<std::size_t>(c)].real();
      rows(row + 1, c) = columns[static_cast<std::size_t>(c)].imag();
    }
    right[row] = f.real();
    right[row + 1] = f.imag();
  }
  AtDelay out;
  const Eigen::Matrix3d normal = rows.transpose() * rows;
  const Eigen::Vector3d scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::Matrix3d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  out.inverse = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  out.found = out.inverse * (rows.transpose() * right);
  if (out.found[2] < 0.0) {  // no damper gives energy: without one
    const Eigen::Matrix2d two = out.inverse.topLeftCorner<2, 2>() -
                                out.inverse.topRightCorner<2, 1>() *
                                    out.inverse.bottomLeftCorner<1, 2>() / out.inverse(2, 2);
    out.found.head<2>() = two * (rows.leftCols<2>().transpose() * right);
    out.found[2] = 0.0;
    out.inverse.setZero();
    out.inverse.topLeftCorner<2, 2>() = two;
  }
  out.sum = (right - rows * out.found).squaredNorm();
  return out;
}

double delay_at(std::size_t step) { return kDelayStepS * static_cast<double>(step); }

/// One axis at each delay of a grid; nothing if it hardly moves at its tones.
std::optional<std::vector<AtDelay>> solve(const Response& r, double hold_s, double usual_mass_kg) {
  double strength = 0.0;
  for (const Complex& x : r.position)
    strength += std::norm(x) / (2.0 * r.noise_m * r.noise_m);
  if (strength < kLeastStrength)
    return std::nullopt;
  std::vector<AtDelay> all;
  for (std::size_t i = 0; i <= kDelaySteps; ++i)
    all.push_back(solve_at(r, delay_at(i), hold_s, usual_mass_kg));
  const AtDelay& best = *std::ranges::min_element(all, {}, &AtDelay::sum);
  // At rest, friction is a stiff spring (presliding), which hides the mass.
  const double inertial = best.found[1] * r.omega.back() * r.omega.back();
  if (best.sum > kMostSum || !(inertial > 0.0) || best.found[0] > kMostSpringRatio * inertial)
    return std::nullopt;
  return all;
}

/// The delays that all axes allow, as steps of the grid.
struct DelayRange {
  std::size_t best = 0, low = 0, high = 0;
  double spread = 1.0;
};
DelayRange common_delay(const std::vector<std::vector<AtDelay>>& axes) {
  DelayRange out;
  std::vector<double> sums(kDelaySteps + 1, 0.0);
  for (const std::vector<AtDelay>& axis : axes)
    for (std::size_t i = 0; i <= kDelaySteps; ++i)
      sums[i] += axis[i].sum;
  out.best = static_cast<std::size_t>(std::ranges::min_element(sums) - sums.begin());
  // A worse fit than the noise widens the bounds. Five values of eight are left over an axis.
  out.spread = std::max(1.0, sums[out.best] / (5.0 * static_cast<double>(axes.size())));
  const double most = sums[out.best] + kSigmas * kSigmas * out.spread;
  out.low = out.high = out.best;
  for (std::size_t i = 0; i <= kDelaySteps; ++i)
    if (sums[i] <= most) {
      out.low = std::min(out.low, i);
      out.high = std::max(out.high, i);
    }
  return out;
}

/// Low and high end of the mass of an axis [kg].
std::array<double, 2> mass_range(const std::vector<AtDelay>& axis, const DelayRange& delay) {
  const double at[] = {axis[delay.low].found[1], axis[delay.best].found[1],
                       axis[delay.high].found[1]};
  const double sd = std::sqrt(delay.spread * std::max(0.0, axis[delay.best].inverse(1, 1)));
  return {std::ranges::min(at) - kSigmas * sd, std::ranges::max(at) + kSigmas * sd};
}

/// A figure that is known to less than a factor agrees or differs; else it is not measured.
StartFigure judged(double low, double high, double least, double most) {
  StartFigure out{.low = low, .high = high, .least = least, .most = most};
  if (high < least || low > most)
    out.finding = Finding::kDiffers;
  else if (high < kAgreeingFactor * most && low > least / kAgreeingFactor)
    out.finding = Finding::kAgrees;
  return out;
}

/// More axes must differ than agree.
StartFigure judged(const std::vector<StartFigure>& axes) {
  StartFigure out;
  if (!axes.empty())
    out.least = axes[0].least, out.most = axes[0].most;
  std::array<int, 3> counts{};
  for (const StartFigure& axis : axes) {
    ++counts[static_cast<std::size_t>(axis.finding)];
    if (axis.finding > out.finding)
      out = axis;
  }
  if (out.finding == Finding::kDiffers && counts[2] <= counts[1])
    out.finding = Finding::kAgrees;
  return out;
}

}  // namespace

namespace {

struct NamedFigure {
  const char *name, *unit;
  double scale;
  const StartFigure* figure;
};
std::array<NamedFigure, 3> named(const StartFindings& f) {
  return {{{"mass", "g", 1e3, &f.mass_kg},
           {"delay", "ms", 1e3, &f.delay_s},
           {"encoder step", "um", 1e6, &f.encoder_step_m}}};
}
std::string between(double low, double high, double scale) {
  return low == high ? fmt::format("{:.4g}", scale * low)
                     : fmt::format("{:.4g} to {:.4g}", scale * low, scale * high);
}

}  // namespace

std::string differences(const StartFindings& findings) {
  std::string out;
  for (const NamedFigure& f : named(findings))
    if (f.figure->finding == Finding::kDiffers)
      out += fmt::format("{}{} {} {}, its file allows {} {}", out.empty() ? "" : "; ", f.name,
                         between(f.figure->low, f.figure->high, f.scale), f.unit,
                         between(f.figure->least, f.figure->most, f.scale), f.unit);
  return out;
}

std::string to_text(const StartFindings& findings) {
  std::string out;
  for (const NamedFigure& f : named(findings)) {
    out += fmt::format("{}{} ", out.empty() ? "" : ", ", f.name);
    if (f.figure->finding == Finding::kNotMeasured)
      out += "not measured";
    else
      out += fmt::format("{} ({} {})", f.figure->finding == Finding::kAgrees ? "agrees" : "differs",
                         between(f.figure->low, f.figure->high, f.scale), f.unit);
  }
  return out;
}

int count_differences(const StartFindings& findings) noexcept {
  int count = 0;
  for (const StartFigure* f : {&findings.mass_kg, &findings.delay_s, &findings.encoder_step_m})
    count += f->finding == Finding::kDiffers;
  return count;
}

void StartCheck::start(const DeviceDescription& expected) {
  expected_ = expected;
  amplitude_n_ =
      std::min(kAcceleration * expected.mass_min_kg, kLargestForceRatio * expected.max_force_n);
  samples_.clear();
  samples_.reserve(static_cast<std::size_t>(kFastestRate * kSeconds * expected.rate_hz) + 16);
  finished_ = false;
}

Vec3 StartCheck::force(double time_s, const Vec3& position_m) noexcept {
  if (finished_)
    return Vec3::Zero();
  if (!std::isfinite(time_s) || !position_m.allFinite() ||
      (!samples_.empty() && time_s <= samples_.back().time_s)) {
    samples_.clear();  // anew: the tones need samples without a gap
    return Vec3::Zero();
  }
  if (samples_.empty())
    first_s_ = time_s;
  const double since = time_s - first_s_;
  if (since > kSeconds || samples_.size() == samples_.capacity()) {
    finished_ = true;
    return Vec3::Zero();
  }
  Vec3 out = Vec3::Zero();
  for (std::size_t k = 0; k < kTones; ++k) {
    const auto n = static_cast<double>(k / 3);  // phases of Schroeder: a low crest
    out[static_cast<Eigen::Index>(k % 3)] +=
        amplitude_n_ * std::cos(tone_omega(k) * since - std::numbers::pi * n * n / kOwn);
  }
  samples_.push_back({time_s, position_m, Vec3::Zero()});
  return out;
}

void StartCheck::applied(const Vec3& force_n) noexcept {
  if (!finished_ && !samples_.empty())
    samples_.back().force_n = force_n;
}

StartFindings StartCheck::findings() const {
  const double period_s = 1.0 / expected_.rate_hz;
  const double lag_s =
      std::isfinite(expected_.force_bandwidth_hz) && expected_.force_bandwidth_hz > 0.0
          ? 1.0 / (2.0 * std::numbers::pi * expected_.force_bandwidth_hz)
          : 0.0;
  const double delay_s = expected_.delay_s + lag_s;
  const double wait_s = expected_.simulated ? 0.0 : period_s;
  const double hand_kg = expected_.grip == "pen" ? kPenHandKg : kArmHandKg;
  const double least_s = delay_s / kAgreeingFactor, most_s = kAgreeingFactor * delay_s + wait_s;
  const double step_m = expected_.position_resolution_m;
  if (static_cast<double>(samples_.size()) < 0.5 * kSeconds * expected_.rate_hz)
    return {};
  std::vector<double> times;
  for (const Sample& s : samples_)
    times.push_back(s.time_s - first_s_);
  const auto rows = static_cast<Eigen::Index>(samples_.size());
  AxisRecord record;
  std::vector<StartFigure> steps_found, masses;
  std::vector<std::vector<AtDelay>> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector position(rows), force(rows);
    record.reserve(samples_.size());
    std::size_t increments = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Sample& s = samples_[static_cast<std::size_t>(i)];
      position[i] = s.position_m[static_cast<Eigen::Index>(axis)];
      force[i] = s.force_n[static_cast<Eigen::Index>(axis)];
      record.add({.time_s = s.time_s, .position_m = position[i]});
      increments += i > 0 && position[i] != position[i - 1];
    }
    if (increments >= kFewestIncrements)
      if (const double step = encoder_step(record); step > 0.0)
        steps_found.push_back(
            judged(step, step, step_m / kAgreeingFactor, step_m * kAgreeingFactor));
    position.array() -= position[0];
    const ToneFit tones(
        times,
        reversals_of(times, position,
                     std::max(kReversalM, kReversalSteps * expected_.position_resolution_m)));
    const auto x = tones.amplitudes(position), f = tones.amplitudes(force);
    Response r;
    double noise = 0.0;
    for (std::size_t k = 0; k < kTones; ++k) {
      if (k % 3 != axis) {
        noise += std::norm(x[k]) / (2.0 * (kTones - kOwn));
        continue;
      }
      r.position[k / 3] = x[k];
      r.force[k / 3] = f[k];
      r.omega[k / 3] = tone_omega(k);
    }
    // Never below the resolution of encoder steps in the mean of all samples.
    const double steps = expected_.position_resolution_m *
                         std::sqrt(2.0 / (12.0 * static_cast<double>(samples_.size())));
    r.noise_m = std::max(std::sqrt(noise), steps);
    if (auto solved = solve(r, period_s, expected_.mass_max_kg))
      axes.push_back(std::move(*solved));
  }
  StartFindings out{.mass_kg = {}, .delay_s = {}, .encoder_step_m = judged(steps_found)};
  if (axes.empty())
    return out;
  const DelayRange delay = common_delay(axes);
  if (delay.high == kDelaySteps)
    return out;
  for (const std::vector<AtDelay>& axis : axes) {
    const auto [low, high] = mass_range(axis, delay);
    masses.push_back(judged(low, high, expected_.mass_min_kg / kAgreeingFactor,
                            kAgreeingFactor * expected_.mass_max_kg + hand_kg));
  }
  out.mass_kg = judged(masses);
  out.delay_s = judged(delay_at(delay.low), delay_at(delay.high), least_s, most_s);
  return out;
}

}  // namespace voxtouch::identification

#include "core/identification/window_response.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace voxtouch::identification {
namespace {

/// Over dt: how far a unit velocity moves, and a unit force from rest, with v' = -rate v + u.
struct Moves {
  double keep, by_velocity, by_force;
};

Moves moves(double rate, double dt) noexcept {
  const double x = rate * dt;
  if (std::abs(x) < 0.3) {
    // (1 - exp(-x)) / x and (exp(-x) - 1 + x) / x^2 by their series.
    double first = 0.0, second = 0.0, term = 1.0, factor = 1.0;
    for (int k = 1; k <= 9; ++k) {
      factor /= k;
      first += term * factor;
      second += term * factor / (k + 1);
      term *= -x;
    }
    const double f = dt * first;
    return {1.0 - rate * f, f, dt * dt * second};
  }
  const double f = -std::expm1(-x) / rate;
  return {1.0 - rate * f, f, (dt - f) / rate};
}

constexpr double kShortestLagS = 20e-6;

constexpr double kDirectionS = 8e-3, kDirectionSpeed = 2e-3;  // half width of the difference; [m/s]

/// Direction of motion of the other axes around an entry, between -1 and 1: joint friction acts
/// against it.
std::array<double, 2> directions(const std::vector<RecordEntry>& e, std::size_t at) noexcept {
  std::size_t first = at, last = at;
  while (first > 0 && e[at].time_s - e[first].time_s < kDirectionS)
    --first;
  while (last + 1 < e.size() && e[last].time_s - e[at].time_s < kDirectionS)
    ++last;
  std::array<double, 2> out{};
  const double time = e[last].time_s - e[first].time_s;
  for (std::size_t k = 0; k < 2 && time > 0.0; ++k) {
    const double v = (e[last].cross_axis.position_m[k] - e[first].cross_axis.position_m[k]) / time;
    out[k] = v / (std::abs(v) + kDirectionSpeed);
  }
  return out;
}

/// The difference between a lagging force and its command, and its effect on the motion; it decays.
class LaggedForce {
 public:
  struct Part {
    double position = 0.0, velocity = 0.0, mean_excess = 0.0;
  };
  LaggedForce(double lag_s, double damping_rate) noexcept
      : lag_(lag_s),
        damping_rate_(damping_rate) {}
  void start(double force) noexcept { force_ = force; }
  Part move(double command, double dt) noexcept {
    if (lag_ <= 0.0 || dt <= 0.0)
      return {};
    const double excess = force_ - command, rate = 1.0 / lag_;
    const Moves slow = moves(damping_rate_, dt), fast = moves(rate, dt);
    force_ = command + excess * fast.keep;
    double difference = rate - damping_rate_;
    if (std::abs(difference) < 1e-6 * rate)
      difference = 1e-6 * rate;
    return {excess * (slow.by_velocity - fast.by_velocity) / difference,
            excess * (slow.keep - fast.keep) / difference, excess * fast.by_velocity / dt};
  }

 private:
  double lag_, damping_rate_, force_ = 0.0;
};

/// A unit mode: y' = p y + u, position Im(y) / omega_d.
class ModeState {
 public:
  explicit ModeState(const Nonlinear& at) {
    const double omega = 2.0 * std::numbers::pi * std::exp(at.log_frequency);
    damped_ = omega * std::sqrt(1.0 - at.damping_ratio * at.damping_ratio);
    pole_ = {-at.damping_ratio * omega, damped_};
  }
  void move(double force, double dt) {
    const std::complex<double> e = std::exp(pole_ * dt);
    y_ = y_ * e + force * (e - 1.0) / pole_;
  }
  double position() const { return y_.imag() / damped_; }
  std::complex<double> free(double time) const { return std::exp(pole_ * time); }

 private:
  std::complex<double> pole_, y_;
  double damped_ = 1.0;
};

}  // namespace

WindowResponse::WindowResponse(const AxisRecord& record, const Window& window, double most_delay_s,
                               double spacing_s)
    : direction_(window.direction) {
  const auto& e = record.entries();
  const double start = e[window.begin].time_s;
  start_ = start;
  double next = start;
  std::vector<double> positions;
  for (std::size_t i = window.begin; i < window.end; ++i) {
    if (e[i].time_s < next)
      continue;
    times_.push_back(e[i].time_s - start);
    positions.push_back(e[i].position_m);
    next = e[i].time_s + spacing_s;
  }
  measured_ = Eigen::Map<const Eigen::VectorXd>(positions.data(),
                                                static_cast<Eigen::Index>(positions.size()));
  if (!positions.empty())
    measured_.array() -= positions.front();
  std::size_t first = window.begin;
  while (first > 0 && e[first].time_s > start - most_delay_s - 0.01)
    --first;
  const double origin = e[window.begin].position_m;
  for (std::size_t i = first; i < window.end; ++i) {
    const CrossAxis& o = e[i].cross_axis;
    const std::array<double, 2> direction = directions(e, i);
    commands_.push_back({e[i].time_s - start,
                         e[i].force_n,
                         {e[i].position_m - origin, o.force_n[0], o.force_n[1], o.position_m[0],
                          o.position_m[1], direction[0], direction[1]}});
    coupled_ = coupled_ || o.position_m[0] != 0.0 || o.position_m[1] != 0.0;
  }
  sent_ = commands_;
}

std::size_t WindowResponse::find_lost_commands(const Nonlinear& at, double inverse_mass,
                                               const Eigen::MatrixXd& local,
                                               Eigen::VectorXd residual, double encoder_step_m) {
  // A lost command changes the velocity by (u_before - u) T / m from then on. Greedy: the command
  // that explains most of the residual, as long as that is more than noise would give.
  constexpr double kLeastOfResidual = 0.03, kLeastOfNoise = 20.0, kMostAmplitudeError = 0.4;
  commands_ = sent_;
  lost_ = 0;
  const double noise = encoder_step_m * encoder_step_m / 12.0;
  const auto count = static_cast<Eigen::Index>(times_.size());
  struct Candidate {
    std::size_t command;
    Eigen::VectorXd bend;
    double square;
  };
  std::vector<Candidate> candidates;
  const double threshold = std::max(kLeastOfNoise * noise, 0.02 * residual.squaredNorm() / 10.0);
  for (std::size_t k = 1; k + 1 < commands_.size(); ++k) {
    const double start = commands_[k].time_s + at.delay_s;
    const double length = commands_[k + 1].time_s - commands_[k].time_s;
    if (start < 0.0 || start + length > times_.back())
      continue;
    const double kick = inverse_mass * (commands_[k - 1].force_n - commands_[k].force_n) * length;
    const double reach = times_.back() - start;
    if (kick * kick * reach * reach * static_cast<double>(count) * 0.05 < threshold)
      continue;
    Candidate c{k, Eigen::VectorXd::Zero(count), 0.0};
    for (Eigen::Index i = count; i-- > 0;) {
      const double since = times_[static_cast<std::size_t>(i)] - start - 0.5 * length;
      if (since <= 0.0)
        break;
      c.bend[i] = kick * moves(at.damping_rate, since).by_velocity;
    }
    c.bend -= local * (local.transpose() * c.bend).eval();
    c.square = c.bend.squaredNorm();
    if (c.square > 0.5 * threshold)
      candidates.push_back(std::move(c));
  }
  std::size_t found = 0;
  const std::size_t most = commands_.size() / 25;
  while (found < most) {
    const Candidate* best = nullptr;
    double most_gain = std::max(kLeastOfNoise * noise, kLeastOfResidual * residual.squaredNorm());
    for (const Candidate& c : candidates) {
      const double gain = 2.0 * c.bend.dot(residual) - c.square;
      if (gain <= most_gain ||
          std::abs(c.bend.dot(residual) - c.square) > kMostAmplitudeError * c.square)
        continue;
      most_gain = gain;
      best = &c;
    }
    if (best == nullptr)
      break;
    residual -= best->bend;
    commands_[best->command].force_n = commands_[best->command - 1].force_n;
    const std::size_t gone = best->command;
    std::erase_if(candidates, [gone](const Candidate& c) {
      return c.command == gone || c.command == gone + 1;
    });
    ++found;
  }
  lost_ += found;
  return found;
}

void WindowResponse::respond(const Nonlinear& at, Eigen::MatrixXd& columns, Eigen::MatrixXd& local,
                             Eigen::MatrixXd& cross_axis) const {
  using Forces = Eigen::Array<double, 1, kCrossAxis + 1>;  // the axis's force, then the forces of
                                                           // the other axes
  const bool with_mode = columns.cols() > 2, with_cross_axis = cross_axis.cols() > 0;
  const auto count = static_cast<Eigen::Index>(times_.size());
  local.resize(count, with_mode ? 4 : 2);
  const bool lags = at.lag_s > kShortestLagS;
  const double delay = std::max(0.0, at.delay_s - (lags ? at.lag_s : 0.0));
  const auto forces_of = [&](const Command& c) {
    Forces f = Forces::Zero();
    f[0] = c.force_n + known_force_n_;
    if (with_cross_axis)
      for (Eigen::Index k = 0; k < kCrossAxis; ++k)
        f[k + 1] = c.cross_axis[static_cast<std::size_t>(k)];
    return f;
  };
  LaggedForce lag(lags ? at.lag_s : 0.0, at.damping_rate);
  std::size_t next = 0;
  Forces force = Forces::Zero();
  double now = 0.0;
  if (!commands_.empty()) {
    force = forces_of(commands_[0]);
    lag.start(force[0]);
    now = commands_[0].time_s + delay;
  }
  // Up to the window only the lag has a state; at its start everything else is local.
  while (next < commands_.size() && commands_[next].time_s + delay <= 0.0) {
    lag.move(force[0], commands_[next].time_s + delay - now);
    now = commands_[next].time_s + delay;
    force = forces_of(commands_[next++]);
  }
  if (now < 0.0)
    lag.move(force[0], -now);
  now = 0.0;
  Forces position = Forces::Zero(), velocity = Forces::Zero();
  ModeState mode(at);
  const auto advance = [&](double until) {
    const double dt = until - now;
    if (!(dt > 0.0))
      return;
    const Moves m = moves(at.damping_rate, dt);
    const LaggedForce::Part part = lag.move(force[0], dt);
    if (with_cross_axis) {
      position += velocity * m.by_velocity + force * m.by_force;
      velocity = velocity * m.keep + force * m.by_velocity;
    } else {
      position[0] += velocity[0] * m.by_velocity + force[0] * m.by_force;
      velocity[0] = velocity[0] * m.keep + force[0] * m.by_velocity;
    }
    position[0] += part.position;
    velocity[0] += part.velocity;
    if (with_mode)
      mode.move(force[0] + part.mean_excess, dt);
    now = until;
  };
  for (Eigen::Index k = 0; k < count; ++k) {
    const double time = times_[static_cast<std::size_t>(k)];
    while (next < commands_.size() && commands_[next].time_s + delay <= time) {
      advance(commands_[next].time_s + delay);
      force = forces_of(commands_[next++]);
    }
    advance(time);
    const Moves free = moves(at.damping_rate, time);
    columns(k, 0) = position[0];
    columns(k, 1) = free.by_force;
    if (with_cross_axis)
      cross_axis.row(k) = position.tail<kCrossAxis>().matrix();
    local(k, 0) = 1.0;
    local(k, 1) = free.by_velocity;
    if (!with_mode)
      continue;
    columns(k, 2) = mode.position();
    const std::complex<double> response = mode.free(time);
    local(k, 2) = response.real();
    local(k, 3) = response.imag();
  }
}

}  // namespace voxtouch::identification

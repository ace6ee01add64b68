#pragma once
/// The response of one window to its commands, exact between events.
#include <Eigen/Core>

#include <array>
#include <vector>

#include "core/identification/axis_record.hpp"
#include "core/identification/windows.hpp"

namespace voxtouch::identification {

struct Nonlinear {
  double delay_s = 0.0;        ///< of transport and force lag together
  double lag_s = 0.0;          ///< first-order lag of the force, part of the delay; 0: none
  double damping_rate = 0.0;   ///< b / m [1/s]
  double log_frequency = 0.0;  ///< of the mode; 0: no mode
  double damping_ratio = 0.0;
};

class WindowResponse {
 public:
  /// Takes the samples at least `spacing_s` apart, and all commands from `most_delay_s` before.
  WindowResponse(const AxisRecord& record, const Window& window, double most_delay_s,
                 double spacing_s);

  /// Finds commands that the device did not apply: it continued with the previous one, which bends
  /// the path by a known amount. `residual`: measured minus modelled. `local`: effect of the
  /// initial values, with orthonormal columns. `inverse_mass`: of the fit. Each search starts from
  /// scratch. Returns the number found.
  std::size_t find_lost_commands(const Nonlinear& at, double inverse_mass,
                                 const Eigen::MatrixXd& local, Eigen::VectorXd residual,
                                 double encoder_step_m);
  void forget_lost_commands() { commands_ = sent_; }
  std::size_t lost_commands() const noexcept { return lost_; }
  std::size_t commands() const noexcept { return commands_.size(); }

  std::size_t samples() const noexcept { return times_.size(); }
  int direction() const noexcept { return direction_; }
  const Eigen::VectorXd& measured() const noexcept { return measured_; }
  const std::vector<double>& times_s() const noexcept { return times_; }  ///< from start_s
  double start_s() const noexcept { return start_; }

  /// Replaces the two columns of friction and bias by forces that are known [N].
  void set_known_force(double force_n) noexcept { known_force_n_ = force_n; }

  /// Other forces with a linear effect: the position of the axis (gravity changes with it); forces,
  /// positions and directions of motion (joint friction) of the other axes.
  static constexpr Eigen::Index kCrossAxis = 7;

  /// Columns of a unit mass: response to the commands, to a constant force of 1 N, of a unit mode
  /// to the commands (third column), and to other forces (`cross_axis`, kCrossAxis columns or
  /// none). `local`: effect of the initial values.
  void respond(const Nonlinear& at, Eigen::MatrixXd& columns, Eigen::MatrixXd& local,
               Eigen::MatrixXd& cross_axis) const;
  bool coupled() const noexcept { return coupled_; }

 private:
  struct Command {
    double time_s, force_n;
    std::array<double, kCrossAxis> cross_axis;
  };
  std::vector<double> times_;      // from the first sample of the window
  std::vector<Command> commands_;  // with lost ones replaced by the previous command
  std::vector<Command> sent_;
  Eigen::VectorXd measured_;
  int direction_;
  double start_ = 0.0;
  std::size_t lost_ = 0;
  bool coupled_ = false;
  double known_force_n_ = 0.0;  // added to all commands
};

}  // namespace voxtouch::identification

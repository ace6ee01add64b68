#pragma once
/// Multipliers that prove a loop stable with any contact whose force never decreases with
/// penetration.
///
/// Let a contact force phi(x) be monotone with slopes in [0, K] (any gap, softening, hardening,
/// several walls). The loop 1 + k L = 0 of sampled_loop.hpp is stable with it if there is a
/// multiplier
///
///     M(z) = 1 - sum h_i z^-i,   i = +-1 .. +-N,   h_i >= 0,   sum h_i < 1
///
/// with
///
///     Re{ M(e^{j w}) (1/K + L(e^{j w})) } > 0   for all w.
///
/// Sources: Zames, Falb 1968; Willems, Brockett 1968 (discrete time); Carrasco, Heath, Zhang,
/// Ahmad, Wang 2020 (search for finite sums); Jonsson, Megretski 2000 (L with a pole at z = 1).
///
/// For design time only.
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/coupling/design/loop_fraction.hpp"

namespace voxtouch::coupling::design {

/// M(z) = at_rest + sum weight_i (1 - z^-i): the M above times a positive number, with h_i equal to
/// weight_i over the sum of all.
struct Multiplier {
  static constexpr int kReach = 20;  ///< N
  using Weights = std::array<double, kReach>;
  double at_rest = 1.0;      ///< M(1) > 0
  Weights past{}, future{};  ///< of i = 1 .. N and of i = -1 .. -N, >= 0
};

/// A loop and the stiffest contact that it must be stable with.
struct ContactLoop {
  LoopOverArc loop;
  double compliance = 0.0;  ///< 1/K >= 0; 0: a contact of any stiffness
  double floor = 0.0;       ///< lower bound of Re{M (1/K + L)} / |M| to prove, > 0
};

/// Floor of a certificate as a ratio of 1/K. The proof also holds for every loop whose L differs
/// from the model's by less than this at all frequencies; rounding is a million times smaller.
inline constexpr double kMultiplierFloor = 2e-4;

/// Result of `prove`.
struct MultiplierProof {
  struct Refuted {
    std::size_t loop;
    double angle;  ///< [rad per sample]
  };
  bool is_multiplier = false;  ///< M(1) > 0 and no weight is negative
  std::vector<Refuted>
      refuted;  ///< loops for which the inequality is not proven, with one angle of each
  bool holds() const noexcept { return is_multiplier && refuted.empty(); }
};
/// Whether M is a multiplier and the inequality holds with its floor on the whole unit circle,
/// including between grid points. On each arc a Taylor model bounds the real part from below. An
/// arc without proof is halved until its middle refutes the inequality or the arc is too short.
MultiplierProof prove(const Multiplier& multiplier, std::span<const ContactLoop> loops);

/// Finds one proven multiplier for all loops, or nothing after 12 rounds. A linear programme over a
/// grid of angles proposes it, and the angles where the proof fails are added to the grid. Takes 1
/// to 20 ms for each loop.
std::optional<Multiplier> find_multiplier(std::span<const ContactLoop> loops);

}  // namespace voxtouch::coupling::design

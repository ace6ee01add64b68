#pragma once
/// The virtual coupling between contact and device: one interface, one sample a step (paper, section 3).
#include <cstdint>
#include <string_view>

#include "core/types/geometry.hpp"

namespace voxtouch {

enum class CouplingKind : std::uint8_t { kDirect = 0, kShapingFilter = 1, kSpringDamper = 2 };
std::string_view name_of(CouplingKind kind) noexcept;
bool parse_coupling(std::string_view word, CouplingKind& kind) noexcept;

/// One sample's input: what the contact gives at the device's pose.
struct CouplingInput {
  Wrench contact;                        ///< W axes
  double contact_stiffness_n_per_m = 0;  ///< stiffness bound of this contact; 0 in free space
};

/// A coupling is stepped once for each device sample. Real-time safe.
class Coupling {
 public:
  virtual ~Coupling() = default;
  virtual CouplingKind kind() const noexcept = 0;
  /// `dt_s` as measured between samples; out of [T/5, 5T] or not finite: the nominal period is used and counted. A
  /// non-finite input holds the last good one and is counted.
  virtual Wrench step(const CouplingInput& input, double dt_s) noexcept = 0;
  /// Starts again at rest, giving `held` without a jump.
  virtual void reset(const Wrench& held) noexcept = 0;
  virtual std::uint64_t faults() const noexcept = 0;  ///< bad periods and bad inputs so far
};

}  // namespace voxtouch

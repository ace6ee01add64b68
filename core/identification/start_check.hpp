#pragma once
/// Checks whether a device still behaves as in its file: one second of tones too weak to notice.
///
/// Each axis gets four different tones between 17 and 61 Hz. The amplitude of each is 0.06 m/s^2
/// times the least mass of the file. The motion of hand and contact is slower. With the force F and
/// the position X at the tones, the axis and the hand that grips it follow
///
///     X (k - m w^2 + j w b) = F exp(-j w (tau + T / 2)),
///
/// linear in k, m and b for each delay tau. Values hidden by encoder steps and friction are
/// reported as not measured.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types/device_description.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::identification {

enum class Finding : std::uint8_t { kNotMeasured, kAgrees, kDiffers };

/// One figure on the first axis with the strongest finding. It differs only if more axes differ
/// than agree.
struct StartFigure {
  Finding finding = Finding::kNotMeasured;
  double low = 0.0, high = 0.0;    ///< 99 % interval of the measured value
  double least = 0.0, most = 0.0;  ///< that agree with the file
};

struct StartFindings {
  StartFigure mass_kg, delay_s, encoder_step_m;
  bool differs() const noexcept {
    return mass_kg.finding == Finding::kDiffers || delay_s.finding == Finding::kDiffers ||
           encoder_step_m.finding == Finding::kDiffers;
  }
};

/// The figures that differ: "delay 4.1 to 4.4 ms, its file allows 2 to 3.2 ms; ...". Empty: none.
std::string differences(const StartFindings& findings);
/// The result for each figure, in one line: "mass not measured, delay agrees (4.1 to 4.4 ms), ...".
std::string to_text(const StartFindings& findings);
int count_differences(const StartFindings& findings) noexcept;

/// The loop calls `force` and `applied` with each sample for a second; then `findings` may be
/// computed in another thread. Both are real-time safe after `start`.
class StartCheck {
 public:
  static constexpr double kSeconds = 1.0;

  /// `expected`: of the file; its lag is a part of the delay. Allocates.
  void start(const DeviceDescription& expected);

  /// Force to add to the command that answers this sample [N]; zero after the end.
  Vec3 force(double time_s, const Vec3& position_m) noexcept;
  /// The force that the device took for that sample [N].
  void applied(const Vec3& force_n) noexcept;
  bool finished() const noexcept { return finished_; }
  bool started() const noexcept { return samples_.capacity() > 0; }
  /// Begins again: the device gave no force for a while.
  void restart() noexcept {
    if (!finished_)
      samples_.clear();
  }

  /// Allocates; takes some 50 ms. Only after the end.
  StartFindings findings() const;

 private:
  struct Sample {
    double time_s = 0.0;
    Vec3 position_m, force_n;
  };
  std::vector<Sample> samples_;
  DeviceDescription expected_;
  double amplitude_n_ = 0.0, first_s_ = 0.0;
  bool finished_ = true;
};

}  // namespace voxtouch::identification

#pragma once
/// Evaluates a reported contact against the reference's gap by the rules of README.md. A pure
/// function: no FCL, files or clocks.
#include <cstdint>
#include <limits>
#include <string>

#include "core/reference/gap.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Values of ValidationReport.verdict and .cause.
enum class Verdict : std::uint32_t { kAgree = 0, kInBand = 1, kDisagree = 2 };
enum class Cause : std::uint32_t { kNone = 0, kRendering = 1, kReference = 2 };

/// Properties of the scene that the rules use. Lengths [m].
struct ValidatorSettings {
  double edge_m = 0.0;         ///< voxel edge e, > 0
  double chord_error_m = 0.0;  ///< ReferenceScene::chord_error_m
  /// Distance within which every point of the dynamic surface has a shell point. The largest
  /// distance between shell points of neighbouring voxels is a good value. sqrt(3) e always holds
  /// for an exact shell, since surface and point share a voxel.
  double shell_gap_m = 0.0;
  double shell_offset_m = 0.0;  ///< Distance of shell points from the surface: 0 for exact shells,
                                ///< sqrt(3)/2 e for voxel centres.
  /// Throws std::invalid_argument naming field, value and rule.
  void validate() const;
};

/// The evaluated contact, as reported in ContactState. World frame.
struct ReportedContact {
  Pose pose_WT;
  Wrench wrench;
  Vec3 mean_normal = Vec3::Zero();
  double deepest_depth_m = 0.0;
  double coherence = 0.0;
  std::uint32_t surface_hits = 0, interior_hits = 0;
  bool latched = false;   ///< FLAG_LATCHED
  bool fallback = false;  ///< FLAG_FALLBACK
};

struct Validation {
  Verdict verdict = Verdict::kInBand;
  Cause cause = Cause::kNone;
  bool decided = false;  ///< one of the two hard rules applied
  double depth_error_m =
      std::numeric_limits<double>::quiet_NaN();  ///< Reported depth minus t, or minus the depth of
                                                 ///< the deepest vertex; NaN: not compared.
  double direction_error_rad =
      std::numeric_limits<double>::quiet_NaN();  ///< Larger error of force and normal; NaN: not
                                                 ///< compared.
  std::string explanation;                       ///< empty without a disagreement
};

struct ValidationCounts {
  std::uint64_t compared =
      0;  ///< decided, or in the band with depth or direction compared with the reference
  std::uint64_t checked = 0, decided = 0, agree = 0, in_band = 0, disagree = 0;
  std::uint64_t rendering = 0, reference = 0;  ///< the disagreements by cause
};

/// Selects every n-th sample by sequence number, independent of timing.
constexpr bool is_checked(std::uint64_t sequence_number, std::uint64_t every) noexcept {
  return every > 0 && sequence_number % every == 0;
}

struct ToolSettings;
struct ReportedTool;

/// Evaluates samples in the order of their sequence numbers; stores counts and the last wrench. Not
/// real-time safe (messages).
class ContactValidator {
 public:
  /// Throws as ValidatorSettings::validate.
  explicit ContactValidator(const ValidatorSettings& settings);

  /// Evaluates one sample of a penalty contact: whether the report is consistent with the gap
  /// `gap`. Allocates.
  Validation validate(const GapResult& gap, const ReportedContact& report);
  /// Evaluates a virtual tool by the rules of tool_validation.hpp.
  Validation validate(const GapResult& at_tool, const GapResult& at_hand, const ToolSettings& tool,
                      const ReportedTool& report);

  const ValidationCounts& counts() const noexcept { return counts_; }
  /// Switches to another scene within the session: counts continue, the last wrench is cleared.
  /// Throws as the constructor.
  void change(const ValidatorSettings& settings);

  double free_limit_m() const noexcept;          ///< a larger gap is free
  double inside_depth_limit_m() const noexcept;  ///< a larger depth must collide

 private:
  /// Consecutive checked samples with bit-identical wrenches.
  struct Run {
    Wrench wrench;
    int samples = 0;
    double least_gap_m = 0.0, largest_gap_m = 0.0;
  };
  void follow(const GapResult& gap, const ReportedContact& report);
  std::string not_usable(const ReportedContact& report) const;
  std::string breach(const GapResult& gap, const ReportedContact& report, Validation& out) const;
  std::string hits_breach(const GapResult& gap, const ReportedContact& report,
                          Validation& out) const;
  std::string force_breach(const ReportedContact& report) const;
  std::string depth_breach(const GapResult& gap, const ReportedContact& report,
                           Validation& out) const;
  std::string direction_breach(const GapResult& gap, const ReportedContact& report,
                               Validation& out) const;
  std::string torque_breach(const GapResult& gap, const ReportedContact& report) const;
  /// Sets verdict and cause from the explanation; `checked`: the cross-checks of the reference
  /// hold.
  static void conclude(bool checked, Validation& out);
  void count(const Validation& validation) noexcept;

  ValidatorSettings settings_;
  ValidationCounts counts_;
  Run run_;
};

}  // namespace voxtouch::reference

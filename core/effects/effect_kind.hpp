#pragma once
/// Name, parameters and behaviour of each kind of effect. The scene reader, its schema, the plan,
/// run-time changes and the manual use this table.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::effects {

class Effect;

enum class ParameterShape : std::uint8_t {
  kNumber,     ///< one number within [low, high]
  kVector,     ///< three numbers; low and high limit the length
  kDirection,  ///< three numbers, normalised; zero is refused
  kWord,       ///< one of `words`; stored as its index; constant at run time
  /// Matches `pattern`, stored in EffectSpec::text with the number 0; constant at run time. At most
  /// one per kind.
  kText,
};

/// One key of an effect in a scene file. Names carry the unit (`stiffness_n_per_m`).
struct EffectParameter {
  std::string_view name;
  ParameterShape shape = ParameterShape::kNumber;
  /// Closed range; infinity is never allowed.
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  std::optional<std::array<double, 3>> standard =
      {};                         ///< default; without one the scene must specify it
  std::string_view meaning = {};  ///< a sentence for the manual and for editors
  std::string_view words = {};    ///< kWord: the choices, separated by single spaces
  std::string_view pattern =
      {};  ///< kText: a regular expression for editors; EffectKind::check_text validates
};

/// The rows of a kind's table. Without a default the scene must specify the value.
namespace row {
/// A number within [low, high], in the unit given by the suffix of the name.
constexpr EffectParameter number(std::string_view name, double low, double high,
                                 std::string_view meaning) {
  return {.name = name, .low = low, .high = high, .meaning = meaning};
}
/// The same with a default.
constexpr EffectParameter number(std::string_view name, double low, double high, double standard,
                                 std::string_view meaning) {
  return {.name = name,
          .low = low,
          .high = high,
          .standard = {{standard, 0.0, 0.0}},
          .meaning = meaning};
}
/// A point in W [m].
constexpr EffectParameter place(std::string_view name, std::string_view meaning) {
  return {.name = name, .shape = ParameterShape::kVector, .meaning = meaning};
}
/// A direction in W, normalised.
constexpr EffectParameter direction(std::string_view name, std::string_view meaning) {
  return {.name = name, .shape = ParameterShape::kDirection, .meaning = meaning};
}
/// Its default is the first of `words`.
constexpr EffectParameter word(std::string_view name, std::string_view words,
                               std::string_view meaning) {
  return {.name = name,
          .shape = ParameterShape::kWord,
          .standard = {{0.0, 0.0, 0.0}},
          .meaning = meaning,
          .words = words};
}
/// An optional text.
constexpr EffectParameter text(std::string_view name, std::string_view pattern,
                               std::string_view meaning) {
  return {.name = name,
          .shape = ParameterShape::kText,
          .standard = {{0.0, 0.0, 0.0}},
          .meaning = meaning,
          .pattern = pattern};
}
}  // namespace row

/// Values of one effect's parameters, three numbers each (a number or word uses the first). The
/// size is constant after construction.
class EffectValues {
 public:
  EffectValues() = default;
  explicit EffectValues(
      std::span<const EffectParameter> parameters);  ///< the defaults; NaN without one

  double number(std::size_t parameter) const noexcept { return values_[parameter][0]; }
  Vec3 vector(std::size_t parameter) const noexcept {
    return {values_[parameter][0], values_[parameter][1], values_[parameter][2]};
  }
  std::array<double, 3>& at(std::size_t parameter) noexcept { return values_[parameter]; }
  const std::array<double, 3>& at(std::size_t parameter) const noexcept {
    return values_[parameter];
  }
  std::size_t size() const noexcept { return values_.size(); }
  bool operator==(const EffectValues&) const = default;

 private:
  std::vector<std::array<double, 3>> values_;
};

/// Energy balance on a closed path of the tool.
enum class EnergyBehaviour : std::uint8_t {
  kConservative,  ///< force of a potential: no energy is generated or dissipated
  kDissipative,   ///< dissipates only
  /// May generate energy, at most that of `EffectBound` or EffectForce::energy_generated_j:
  /// texture, moving objects.
  kBounded,
};

/// Upper bounds for an effect with given values. Infinity without a bound: such values are refused.
struct EffectBound {
  double stiffness_n_per_m = 0.0;  ///< spectral norm of -d(force)/d(position)
  double stiffness_nm_per_rad = 0.0;
  double damping_ns_per_m = 0.0;  ///< spectral norm of -d(force)/d(velocity)
  double damping_nms_per_rad = 0.0;
  double force_n = std::numeric_limits<double>::infinity();      ///< infinity if unknown
  double potential_j = std::numeric_limits<double>::infinity();  ///< |U| of a conservative kind;
                                                                 ///< infinity if unknown.
  double energy_per_metre_j = 0.0;  ///< kBounded: largest energy per metre of the tool's path
  double external_force_n = 0.0,
         external_torque_nm = 0.0;  ///< From a source outside the ring that may react to the pose:
                                    ///< no certificate covers it.
};

/// Resources of an effect; the plan is the union over the scene's effects.
struct EffectNeeds {
  bool twist = false;    ///< the tool's velocity
  bool contact = false;  ///< results of the contact models in this sample
  bool torque = false;   ///< gives torque: not displayed by a device of three degrees of freedom
  bool orientation = false;  ///< depends on the orientation of the tool
  bool body = false;         ///< the dynamic object has its own motion: rigid_body.hpp
  bool external = false;     ///< follows a program outside the ring: EffectFrame::external
  double proximity_m = 0.0;  ///< range of distances to the static surface [m]; 0: none
  double smoothing_m = 0.0;  ///< minimum smoothing length [m]
  /// Largest allowed distance of a tool point from its origin [m].
  double lever_m = std::numeric_limits<double>::infinity();
};

struct EffectKind {
  std::string_view name;       ///< key in the scene's list of effects
  std::string_view summary;    ///< one sentence for messages
  std::string_view equations;  ///< force law, source and stability condition, as text
  EnergyBehaviour energy = EnergyBehaviour::kConservative;
  bool alone = false;       ///< a scene has at most one: two would contradict each other (gravity)
  bool everywhere = false;  ///< takes no region, gain or switch: a fraction of it is meaningless
  bool scales_inside =
      false;  ///< Stores energy: scales its limits by EffectFrame::fraction itself, since a stored
              ///< force scaled from outside would return more energy than it received.
  /// Coulomb coefficient of a kind whose work a virtual tool takes over; null for all others.
  double (*friction)(const EffectValues&) = nullptr;
  std::span<const EffectParameter> parameters;
  EffectNeeds (*needs)(const EffectValues&) = [](const EffectValues&) {
    return EffectNeeds{};
  };  ///< only the position
  EffectBound (*bound)(const EffectValues&) = nullptr;
  /// Checks conditions beyond the ranges, e.g. low > high. Returns a sentence, or an empty text.
  std::string (*check)(const EffectValues&) = nullptr;
  /// Checks the text of its kText parameter. Returns the fault as a continuation of the text, "does
  /// not begin ...", or an empty text.
  std::string (*check_text)(std::string_view) = nullptr;
  std::unique_ptr<Effect> (*make)() = nullptr;
  double expected_ns = 50.0;  ///< Of one `apply`, from counting its operations; the plan uses it as
                              ///< the expected cost [ns].
};

/// All kinds, sorted by name.
std::span<const EffectKind* const> effect_kinds() noexcept;
/// Null for an unknown name.
const EffectKind* find_effect_kind(std::string_view name) noexcept;

/// Checks one value by the rules of check_values below.
std::string check_value(const EffectParameter& parameter, const std::array<double, 3>& value);
/// Names the first value that is missing, not finite or out of range, as a sentence; empty if all
/// are valid. Directions must be unit vectors to 1e-6.
std::string check_values(const EffectKind& kind, const EffectValues& values);

}  // namespace voxtouch::effects

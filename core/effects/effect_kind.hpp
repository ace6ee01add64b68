#pragma once
/// What a kind of effect is called, which parameters it takes and how it behaves: one table that
/// the scene reader, its schema, the plan, the change while running and the manual all read.
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
  kVector,     ///< three numbers; low and high are for its length
  kDirection,  ///< three numbers, brought to unit length; zero is refused
  kWord,       ///< one of `words`; its place in the list is kept as a number; never changes while
               ///< running
  kText,  ///< as `pattern` has it, kept in EffectSpec::text, and 0 as a number; never changes while
          ///< running. One of a kind at most
};

/// One key of an effect in a scene file. Names carry the unit (`stiffness_n_per_m`).
struct EffectParameter {
  std::string_view name;
  ParameterShape shape = ParameterShape::kNumber;
  double low = 0.0, high = std::numeric_limits<double>::infinity();  ///< closed, save that infinity
                                                                     ///< is never allowed
  std::optional<std::array<double, 3>> standard =
      {};                         ///< where the scene says nothing; none: the scene must say it
  std::string_view meaning = {};  ///< a sentence for the manual and for editors
  std::string_view words = {};    ///< kWord: the choices, parted by single spaces
  std::string_view pattern =
      {};  ///< kText: a regular expression for editors; EffectKind::check_text judges
};

/// The rows of a kind's table; without a standard the scene must give the value.
namespace row {
/// A number within [low, high], in the unit that the name ends in.
constexpr EffectParameter number(std::string_view name, double low, double high,
                                 std::string_view meaning) {
  return {.name = name, .low = low, .high = high, .meaning = meaning};
}
/// The same with a standard.
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
/// A direction in W, brought to unit length.
constexpr EffectParameter direction(std::string_view name, std::string_view meaning) {
  return {.name = name, .shape = ParameterShape::kDirection, .meaning = meaning};
}
/// Its standard is the first of `words`.
constexpr EffectParameter word(std::string_view name, std::string_view words,
                               std::string_view meaning) {
  return {.name = name,
          .shape = ParameterShape::kWord,
          .standard = {{0.0, 0.0, 0.0}},
          .meaning = meaning,
          .words = words};
}
/// A text that may be left out.
constexpr EffectParameter text(std::string_view name, std::string_view pattern,
                               std::string_view meaning) {
  return {.name = name,
          .shape = ParameterShape::kText,
          .standard = {{0.0, 0.0, 0.0}},
          .meaning = meaning,
          .pattern = pattern};
}
}  // namespace row

/// Values of one effect's parameters, three numbers each (a number or word uses the first). Fixed
/// in size once made.
class EffectValues {
 public:
  EffectValues() = default;
  explicit EffectValues(
      std::span<const EffectParameter> parameters);  ///< the standards; NaN where there is none

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

/// Where energy goes on a closed path of the tool.
enum class EnergyBehaviour : std::uint8_t {
  kConservative,  ///< force from a potential: none is given or taken
  kDissipative,   ///< taken, never given
  kBounded,  ///< may be given, at most what `EffectBound` or EffectForce::energy_generated_j says:
             ///< texture, moving objects
};

/// What an effect with given values can do at most. Infinity where nothing holds: such values are
/// refused.
struct EffectBound {
  double stiffness_n_per_m = 0.0;  ///< spectral norm of -d(force)/d(position)
  double stiffness_nm_per_rad = 0.0;
  double damping_ns_per_m = 0.0;  ///< spectral norm of -d(force)/d(velocity)
  double damping_nms_per_rad = 0.0;
  double force_n = std::numeric_limits<double>::infinity();  ///< where one is known
  double potential_j =
      std::numeric_limits<double>::infinity();  ///< |U| of a conservative kind, where one is known
  double energy_per_metre_j = 0.0;  ///< kBounded: given per metre of the tool's path at most
  double external_force_n = 0.0,
         external_torque_nm =
             0.0;  ///< by who may react to the pose, outside the ring: no certificate covers it
};

/// What must be there for an effect; the plan is the union over the scene's effects.
struct EffectNeeds {
  bool twist = false;        ///< the tool's velocity
  bool contact = false;      ///< what the contact models found this sample
  bool torque = false;       ///< gives torque: a device of three degrees of freedom cannot show it
  bool orientation = false;  ///< looks at how the tool is turned
  bool body = false;         ///< the dynamic object moves by itself: rigid_body.hpp
  bool external = false;     ///< follows a program outside the ring: EffectFrame::external
  double proximity_m = 0.0;  ///< distances to the static surface out to here [m]; 0: none
  double smoothing_m = 0.0;  ///< and smoothed over this length at least [m]
  double lever_m = std::numeric_limits<double>::infinity();  ///< no point of the tool is farther
                                                             ///< from its origin [m]
};

struct EffectKind {
  std::string_view name;       ///< key in the scene's list of effects
  std::string_view says;       ///< one sentence for people: what is displayed
  std::string_view equations;  ///< force law, source and stability condition, as text
  EnergyBehaviour energy = EnergyBehaviour::kConservative;
  bool alone = false;       ///< a scene has one at most: two would contradict each other (gravity)
  bool everywhere = false;  ///< takes no region, gain or switch: half of it would be nothing
  bool scales_inside =
      false;  ///< stores energy: scales its limits by EffectFrame::fraction itself, since a stored
              ///< force that is scaled from outside comes back larger than it was put in
  /// Coulomb's coefficient, of a kind whose work a virtual tool does itself where there is one;
  /// null of all others.
  double (*friction)(const EffectValues&) = nullptr;
  std::span<const EffectParameter> parameters;
  EffectNeeds (*needs)(const EffectValues&) = [](const EffectValues&) {
    return EffectNeeds{};
  };  ///< nothing but the position
  EffectBound (*bound)(const EffectValues&) = nullptr;
  /// What the ranges alone do not say, e.g. low > high: a sentence, empty where all is well.
  std::string (*check)(const EffectValues&) = nullptr;
  /// What is wrong with the text of its kText parameter, to follow the text: "does not begin ...";
  /// empty where nothing is.
  std::string (*check_text)(std::string_view) = nullptr;
  std::unique_ptr<Effect> (*make)() = nullptr;
  double expected_ns =
      50.0;  ///< of one `apply`, from counting its steps: what the plan expects of a frame [ns]
};

/// All kinds, sorted by name.
std::span<const EffectKind* const> effect_kinds() noexcept;
/// Null where there is none of that name.
const EffectKind* find_effect_kind(std::string_view name) noexcept;

/// One value, as check_values below judges it.
std::string check_value(const EffectParameter& parameter, const std::array<double, 3>& value);
/// Names the first value that is missing, not finite or out of range, as a sentence; empty where
/// all are good. Directions must be of unit length to 1e-6.
std::string check_values(const EffectKind& kind, const EffectValues& values);

}  // namespace voxtouch::effects

#pragma once
/// What would give the hand more force: changes of the scene or the laboratory, each found by
/// computing what is felt with it.
#include <cstdint>
#include <string>
#include <vector>

#include "core/felt/press.hpp"

namespace voxtouch::felt {

inline constexpr double kDepthToldM = 0.01;   ///< of the hand: press.hpp goes as deep
inline constexpr double kWorthTelling = 1.1;  ///< a change gives at least so many times the force

/// What is rendered and felt, as it is or as it would be.
struct Felt {
  scene::Scene scene;
  coupling::design::DeviceModel device;
  rendering::StiffnessBounds contact;  ///< in W, without effects: Plan::of_contact_alone
  fitting::FittedCoupling fitted;      ///< to these
};

/// What `fit_coupling` is asked for: contact and effects.
rendering::StiffnessBounds bounds_of(const Felt& felt);
/// Stiffness at the hand of a virtual tool's spring or of a body's grip [N/m]; of other contact 0.
double stiffness_n_per_m(const Felt& felt);
/// Force at the hand 10 mm deep [N]: of a virtual tool or a body its stiffness times that, else as
/// `press` finds it on `motion`, which may be null. `built` is of the scene, or of one that it
/// scales. 0: nothing may be felt, or the motion touches nothing.
double force_n(const Felt& felt, rendering::BuiltScene& built, const Motion* motion);

struct Change {
  std::string what;      ///< "coupling.kind: direct"
  double force_n = 0.0;  ///< that the hand gets with it, 10 mm deep

  bool operator==(const Change&) const = default;
};

/// Which of them are computed.
enum class Search : std::uint8_t {
  kKnown,  ///< none but what the fit knows already: for a start that must not wait
  kFirst,  ///< in the order of what mostly helps, until there are enough: a fit or two each
  kAll,    ///< each of the scene; and where these are too few, a shorter delay and a higher rate
};

/// The changes that give most, `most` at most, the best first; each gives at least a tenth more
/// than `now_n`. Each is one change, all else as it is. Empty: there is none. Some tenths of a
/// second to a few seconds; not for the loop.
std::vector<Change> changes(const Felt& now, double now_n, rendering::BuiltScene& built,
                            const Motion* motion, std::size_t most, Search search);

}  // namespace voxtouch::felt

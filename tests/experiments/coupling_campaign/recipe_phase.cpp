#include <algorithm>
#include <numbers>

#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {

PhaseResult recipe_phase(const Options& options) {
  PhaseResult out{
      .name = "literal recipe, 5 Hz, d = 1", .tallies = {}, .figures = {}, .failures = {}};
  for (std::uint64_t i = 0; i < options.members; ++i) {
    const coupling_models::PopulationMember member =
        coupling_models::draw_member(options.seed, options.first + i);
    coupling_models::Random random(options.seed ^ 0x5eed0a, options.first + i);
    const coupling::design::AxisModel& axis = member.device.translation;
    const double displayed = std::min(member.contact.all_points, axis.max_stiffness);
    const auto run = [&](const char* kind, bool gripped, double friction) {
      coupling_models::NonlinearLoop loop;
      coupling_models::PopulationMember who = member;
      who.hand.any_passive = false, who.hand.may_release = false;
      loop.plant = coupling_models::draw_plant(who, random);
      if (!gripped)
        loop.plant.hand_mass = loop.plant.hand_damping = loop.plant.hand_stiffness = 0.0;
      loop.controller.w0_rad_per_s = 10.0 * std::numbers::pi;
      loop.controller.gain = displayed / member.contact.all_points;
      loop.contact_stiffness = member.contact.all_points;
      loop.coulomb_friction = friction;
      disturb(loop, member.device.timing, axis.resolution, random);
      drive(loop, displayed, axis.max_effort, random);
      out.count(kind, coupling_models::simulate(loop));
    };
    run("released", false, 0.0);
    if (axis.coulomb_friction > 0.0)
      run("released, with the device's friction", false, axis.coulomb_friction);
    run("gripped", true, 0.0);
    if (options.progress)
      options.progress(i + 1, options.members);
  }
  return out;
}

}  // namespace voxtouch::campaign

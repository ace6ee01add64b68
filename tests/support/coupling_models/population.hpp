#pragma once
/// Random devices, hands and contacts for experiments: a seed gives bit-identical results on every
/// machine.
///
/// Ranges: Phantom-like m .03-.2 kg, b .003-1 Ns/m, contact 20-5000 N/m, held like a stylus;
/// LWR-like m 1.6-24 kg, b 6-63 Ns/m, contact 100-16000 N/m, led by an arm. Both: T .25-4 ms, delay
/// 0-4 T, effort lag 0-5 ms, encoder step 1-63 um.
#include <cstdint>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"
#include "tests/support/coupling_models/random.hpp"

namespace voxtouch::coupling_models {

struct Interval {
  double low, high;
};

enum class DeviceFamily : std::uint8_t { kPhantomLike, kLwrLike };

/// Ranges of a family's members. Translation only.
struct FamilyRanges {
  Interval mass, damping, contact, max_effort, max_stiffness, coulomb_friction;
  Interval hand_mass, hand_damping, hand_stiffness;
};
const FamilyRanges& ranges_of(DeviceFamily family) noexcept;

inline constexpr Interval kPeriods{0.25e-3, 4e-3}, kDelaysInPeriods{0.0, 4.0},
    kEffortLags{0.0, 5e-3}, kResolutions{1e-6, 63e-6};

struct PopulationMember {
  std::uint64_t seed = 0, index = 0;  ///< draw_member(seed, index) gives it again
  DeviceFamily family = DeviceFamily::kPhantomLike;
  coupling::design::DeviceModel device;  ///< gives no torque
  coupling::design::HandRange hand;
  coupling::design::ContactRange contact;
};

/// Member `index` of population `seed`: even indices Phantom-like, odd ones LWR-like. Half of the
/// devices have one mass, the others up to three times the least; half have dry friction. Hands:
/// the family's whole range or a part of it; 70 % may release, 10 % are "any passive hand".
PopulationMember draw_member(std::uint64_t seed, std::uint64_t index);

/// Every vertex of a family's ranges of mass, damping, contact, period, delay, lag and encoder
/// step: 2^7 members, with the family's whole range of hands, which may release.
std::vector<PopulationMember> corner_members(DeviceFamily family);

/// One device with one hand out of a member's ranges. `any_passive` hands are drawn far beyond the
/// family's range: masses and stiffnesses over four and five decades, next to no damping.
coupling::design::LoopPlant draw_plant(const PopulationMember& member, Random& random);
/// Every vertex: least and largest mass of the device, released (if it may) and the hand's eight
/// corners and centre. For `any_passive` the family's range serves as the box.
std::vector<coupling::design::LoopPlant> vertex_plants(const PopulationMember& member);

}  // namespace voxtouch::coupling_models

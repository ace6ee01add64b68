#pragma once
/// Wrenches against true ones, as the figures of one row.
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::accuracy {

/// Measured and true value of one contact, in the same unit.
struct WrenchPair {
  Wrench given, truth;
};

/// Angle [deg] between two vectors; 180 if either is zero.
double angle_deg(const Vec3& a, const Vec3& b) noexcept;
/// Middle of the sorted values (the upper of two); 0 for none.
double median_of(std::vector<double> values);
/// The smallest value that is not below 95 % of them; 0 for none.
double p95_of(std::vector<double> values);

/// Distribution-free 95 % interval of the median, between two of the sorted values: the binomial
/// distribution leaves at most 2.5 % beyond either (David and Nagaraja 2003, 7.1). Unknown for
/// fewer than six values.
Interval median_interval(std::vector<double> values);

/// Fills contacts, missed, mean direction and size of the force. A pair with a true value of zero
/// is ignored.
void judge_forces(const std::vector<WrenchPair>& pairs, ErrorFigures& figures);
/// The same, and median directions, torque and their intervals.
void judge_wrenches(const std::vector<WrenchPair>& pairs, AccuracyRow& row);
/// Fills the onset figures and their interval from the gaps [m] at which the force began.
void judge_onsets(const std::vector<double>& gaps_m, AccuracyRow& row);

}  // namespace voxtouch::accuracy

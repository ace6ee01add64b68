#pragma once
/// Common parts of the virtual tool's hard cases: a voxel edge, a slot, and invariants of every
/// frame.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exact/limits.hpp"
#include "tests/experiments/virtual_tool/runs.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::virtual_tool {

inline constexpr double kEdge = 0.002;

inline bool finite(const exact::VirtualToolFrame& f) {
  return f.tool.finite() && f.wrench(kStiffness).finite() && f.stiffness(kStiffness).allFinite() &&
         f.contact_point.allFinite() && std::isfinite(f.residual_m);
}

/// Invariants of every frame in every scene.
inline void expect_sound(const exact::VirtualToolFrame& f) {
  ASSERT_TRUE(finite(f));
  ASSERT_LE(f.queries, exact::limits::kMaxQueries);
  ASSERT_GE(f.ratio, 0.0);
  ASSERT_LE(f.ratio, 1.0);
}

inline mesh::TriangleMesh slot_mesh(double width) {
  return test::joined(test::box_mesh(Vec3(0.02, 0.06, 0.04),
                                     {Vec3(-0.5 * width - 0.01, 0, -0.02), Quat::Identity()}),
                      test::box_mesh(Vec3(0.02, 0.06, 0.04),
                                     {Vec3(0.5 * width + 0.01, 0, -0.02), Quat::Identity()}));
}

}  // namespace voxtouch::virtual_tool

#pragma once
/// The exact shell of a tool in one call, for tests that ask nothing of its single points.
#include "core/pointshell/build_shell.hpp"

namespace voxtouch::test {

inline Pointshell exact_shell(const TriangleMesh& mesh, const Grid& grid, const ParallelFor& parallel_for = serial_for()) {
  return make_exact_shell(shell_points(mesh, grid, parallel_for), grid);
}
inline Pointshell exact_shell(const TriangleMesh& mesh, double edge_m, const ParallelFor& parallel_for = serial_for()) {
  return exact_shell(mesh, default_grid(mesh, edge_m), parallel_for);
}

}  // namespace voxtouch::test

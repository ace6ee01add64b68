#pragma once
/// The exact shell of a tool in one call, for tests that do not need its single points.
#include "core/pointshell/build_shell.hpp"

namespace voxtouch::test {

inline pointshell::Pointshell exact_shell(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid,
                                          const ParallelFor& parallel_for = serial_for()) {
  return pointshell::make_exact_shell(pointshell::shell_points(mesh, grid, parallel_for), grid);
}
inline pointshell::Pointshell exact_shell(const mesh::TriangleMesh& mesh, double edge_m,
                                          const ParallelFor& parallel_for = serial_for()) {
  return exact_shell(mesh, voxmap::default_grid(mesh, edge_m), parallel_for);
}

}  // namespace voxtouch::test

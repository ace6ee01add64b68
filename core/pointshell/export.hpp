#pragma once
/// Voxels and shell points as files. Numbers are written shortest-that-reads-back, whatever the
/// locale.
#include <ostream>
#include <vector>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::pointshell {

/// `<mesh>_surface.csv`: i,j,k,open,px..pz,nx..nz,mx..mz,tri,dist,coh,tie,fallback; row number =
/// point id. fallback: NormalRule, plus 4 if the plain normals m cancel and m is zero.
void write_surface_csv(std::ostream& out, const std::vector<ShellPoint>& points);

/// `<mesh>_interior.csv`: i,j,k_first,k_last, runs along k, sorted.
void write_interior_csv(std::ostream& out, const voxmap::Voxmap& map);

/// PLY, binary little-endian, doubles x y z nx ny nz area: opens in MeshLab and CloudCompare.
/// Vertex number = point id.
void write_shell_ply(std::ostream& out, const std::vector<ShellPoint>& points);

}  // namespace voxtouch::pointshell

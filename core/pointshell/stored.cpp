/// Pointshells as bytes.
#include <algorithm>
#include <cmath>

#include "core/pointshell/pointshell.hpp"
#include "core/types/stored_bytes.hpp"

namespace voxtouch::pointshell {
namespace {

template <class Archive, class Shell>
void fields(Archive& archive, Shell& shell) {
  auto& [x, y, z, nx, ny, nz, area_m2, coherence, id, edge] =
      shell;  // all there are: one more does not compile
  archive(x), archive(y), archive(z), archive(nx), archive(ny), archive(nz), archive(area_m2),
      archive(coherence), archive(id), archive(edge);
}

}  // namespace

void put(const Pointshell& shell, ByteWriter& out) { fields(out, shell); }

Pointshell take_shell(ByteReader& in) {
  Pointshell shell;
  fields(in, shell);
  const std::size_t size = shell.size();
  for (const std::vector<double>* row : {&shell.x, &shell.y, &shell.z, &shell.nx, &shell.ny,
                                         &shell.nz, &shell.area_m2, &shell.coherence}) {
    ByteReader::require(row->size() == size, "points with rows of unequal length");
    ByteReader::require(
        std::ranges::all_of(*row, [](double value) { return std::isfinite(value); }),
        "a point that is not finite");
  }
  ByteReader::require(shell.id.size() == size && std::isfinite(shell.edge) && shell.edge > 0.0,
                      "a shell without ids or edge");
  std::vector<std::uint8_t> seen(size, 0);
  for (std::size_t p = 0; p < size; ++p) {
    ByteReader::require(std::abs(shell.normal(p).squaredNorm() - 1.0) < 1e-6,
                        "a normal that is none");
    ByteReader::require(
        shell.area_m2[p] >= 0.0 && shell.coherence[p] >= 0.0 && shell.coherence[p] <= 1.0 + 1e-6,
        "an area or coherence that is none");
    ByteReader::require(shell.id[p] < size && seen[shell.id[p]]++ == 0,
                        "an id that no point has, or two");
  }
  return shell;
}

}  // namespace voxtouch::pointshell

#include "core/pointshell/export.hpp"

#include <bit>
#include <charconv>
#include <string>

namespace voxtouch::pointshell {
namespace {

constexpr int kPlainCancels = 4;  ///< in the column `fallback`

/// A line of comma-separated numbers.
class Row {
 public:
  template <class Number>
  Row& add(Number value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    if (!line_.empty())
      line_ += ',';
    line_.append(text, end);
    return *this;
  }
  Row& add(const Vec3& v) { return add(v.x()).add(v.y()).add(v.z()); }
  void write(std::ostream& out) {
    line_ += '\n';
    out.write(line_.data(), static_cast<std::streamsize>(line_.size()));
    line_.clear();
  }

 private:
  std::string line_;
};

void put_double(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int n = 0; n < 8; ++n)
    bytes += static_cast<char>((bits >> (8 * n)) & 0xff);
}

}  // namespace

void write_surface_csv(std::ostream& out, const std::vector<ShellPoint>& points) {
  out << "i,j,k,open,px,py,pz,nx,ny,nz,mx,my,mz,tri,dist,coh,tie,fallback\n";
  Row row;
  for (const ShellPoint& p : points) {
    row.add(p.voxel.i).add(p.voxel.j).add(p.voxel.k).add(int{p.open});
    row.add(p.point).add(p.normal).add(p.plain_normal);
    row.add(p.triangle)
        .add(p.distance_m)
        .add(p.coherence)
        .add(int{p.tie})
        .add(static_cast<int>(p.rule) + (p.plain_cancels ? kPlainCancels : 0));
    row.write(out);
  }
}

void write_interior_csv(std::ostream& out, const voxmap::Voxmap& map) {
  out << "i,j,k_first,k_last\n";
  Row row;
  voxmap::VoxelIndex first, last;
  bool running = false;
  const auto finish_run = [&] {
    if (running)
      row.add(first.i).add(first.j).add(first.k).add(last.k).write(out);
    running = false;
  };
  map.for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) {
    if (running && !(kind == voxmap::VoxelKind::kInterior && v.i == last.i && v.j == last.j &&
                     v.k == last.k + 1))
      finish_run();
    if (kind != voxmap::VoxelKind::kInterior)
      return;
    if (!running)
      first = v;
    running = true;
    last = v;
  });
  finish_run();
}

void write_shell_ply(std::ostream& out, const std::vector<ShellPoint>& points) {
  out << "ply\nformat binary_little_endian 1.0\n"
      << "comment pointshell; x y z [m], n inward unit normal, area [m^2]\n"
      << "element vertex " << std::to_string(points.size()) << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "area"})
    out << "property double " << name << '\n';
  out << "end_header\n";
  std::string bytes;
  for (const ShellPoint& p : points) {
    bytes.clear();
    for (const double value : {p.point.x(), p.point.y(), p.point.z(), p.normal.x(), p.normal.y(),
                               p.normal.z(), p.area_m2})
      put_double(bytes, value);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
}

}  // namespace voxtouch::pointshell

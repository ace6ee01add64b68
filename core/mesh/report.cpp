#include "core/mesh/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string_view>

#include "core/mesh/topology.hpp"
#include "core/mesh/weld.hpp"

namespace voxtouch::mesh {
namespace {

double six_volumes(const TriangleMesh& mesh, std::uint32_t t, const Vec3& about) {
  return (mesh.corner(t, 0) - about)
      .dot((mesh.corner(t, 1) - about).cross(mesh.corner(t, 2) - about));
}

std::vector<std::uint32_t> of_kind(const std::vector<TriangleKind>& kinds, bool with_zero_area) {
  std::vector<std::uint32_t> which;
  for (std::uint32_t t = 0; t < kinds.size(); ++t) {
    if (kinds[t] == TriangleKind::kSound || (with_zero_area && kinds[t] == TriangleKind::kZeroArea))
      which.push_back(t);
  }
  return which;
}

Finding open_edges_of(const std::vector<Side>& sides) {
  std::vector<std::uint32_t> open;
  for_edges(sides, [&](std::size_t first, std::size_t last) {
    if (last - first == 1)
      open.push_back(sides[first].triangle);
  });
  std::sort(open.begin(), open.end());
  Finding finding;
  for (const std::uint32_t t : open)
    finding.add(t);
  return finding;
}

void count_vertices(const TriangleMesh& mesh, const std::vector<std::uint32_t>& stands,
                    MeshReport& report) {
  const std::vector<std::uint8_t> used = used_vertices(mesh);
  std::vector<std::uint8_t> point(used.size(), 0);
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v])
      report.unused_vertices.add(v);
    if (!mesh.vertices[v].allFinite())
      report.not_finite_vertices.add(v);
    if (used[v] && !point[stands[v]])
      point[stands[v]] = 1, ++report.points;
  }
  const Eigen::AlignedBox3d box = bounds(mesh);
  if (!box.isEmpty())
    report.min = box.min(), report.max = box.max();
}

void count_kinds(const std::vector<TriangleKind>& kinds, MeshReport& report) {
  for (std::uint32_t t = 0; t < kinds.size(); ++t) {
    if (kinds[t] == TriangleKind::kZeroArea)
      report.zero_area.add(t);
    if (kinds[t] == TriangleKind::kDuplicate)
      report.duplicates.add(t);
    if (kinds[t] == TriangleKind::kOppositeDuplicate)
      report.opposite_duplicates.add(t);
  }
}

void count_edges(const std::vector<Side>& sides, MeshReport& report) {
  std::vector<std::uint32_t> crowded;
  for_edges(sides, [&](std::size_t first, std::size_t last) {
    ++report.edges;
    if (last - first > 2)
      crowded.push_back(sides[first].triangle);
  });
  std::sort(crowded.begin(), crowded.end());
  for (const std::uint32_t t : crowded)
    report.non_manifold_edges.add(t);
}

/// A piece of a mesh that hangs together.
struct Part {
  std::uint32_t lowest = 0;  ///< triangle
  Eigen::AlignedBox3d box;
  std::vector<std::uint32_t> triangles;
};

/// How often the part winds round a point (Van Oosterom and Strackee 1983): 1 inside, 0 outside.
double winding_number(const TriangleMesh& mesh, const Part& part, const Vec3& x) {
  double sum = 0.0;
  for (const std::uint32_t t : part.triangles) {
    const Vec3 a = mesh.corner(t, 0) - x, b = mesh.corner(t, 1) - x, c = mesh.corner(t, 2) - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    sum += std::atan2(a.dot(b.cross(c)), below);
  }
  return sum / (2.0 * std::numbers::pi);
}

/// Whether sampled corners of `inner` are all inside the solid of the surrounding parts.
bool lies_in_solid(const TriangleMesh& mesh, const Part& inner,
                   const std::vector<const Part*>& round) {
  constexpr std::size_t kCorners = 8;
  const std::size_t step = std::max(inner.triangles.size() / kCorners, std::size_t{1});
  for (std::size_t k = 0; k < inner.triangles.size(); k += step) {
    double winding = 0.0;
    for (const Part* part : round)
      winding += winding_number(mesh, *part, mesh.corner(inner.triangles[k], 0));
    if (std::abs(winding) < 0.5)
      return false;
  }
  return true;
}

/// `parts`: all of a closed mesh. `volume`: of each, above 0 if it faces outward.
void find_nested(const TriangleMesh& mesh, const std::vector<Part>& parts,
                 const std::vector<double>& volume, MeshReport& report) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t p) { return parts[p].box.volume(); });
  std::vector<std::uint32_t> nested;
  std::int64_t steps = 300'000'000;  // boxes compared, and 100 for each angle: about a second
  for (std::size_t k = 1; k < order.size() && steps > 0; ++k) {
    const Part& inner = parts[order[k]];
    if (volume[order[k]] <= 0.0)
      continue;
    std::vector<const Part*> round;
    for (std::size_t outer = 0; outer < k; ++outer) {
      if (parts[order[outer]].box.contains(inner.box))
        round.push_back(&parts[order[outer]]);
    }
    for (const Part* part : round)
      steps -= 800 * static_cast<std::int64_t>(part->triangles.size());
    steps -= static_cast<std::int64_t>(k);
    if (!round.empty() && lies_in_solid(mesh, inner, round))
      nested.push_back(inner.lowest);
  }
  std::ranges::sort(nested);
  for (const std::uint32_t t : nested)
    report.nested_parts.add(t);
}

void judge_orientation(const TriangleMesh& mesh, const std::vector<Side>& sides,
                       const std::vector<std::uint32_t>& sound, MeshReport& report) {
  const Orientation o = orientation_of(sides, sound, mesh.triangles.size());
  report.parts = o.parts;
  report.orientable = o.orientable;
  const Vec3 about = 0.5 * (report.min + report.max);
  std::vector<double> part_volume(o.parts, 0.0);
  std::vector<std::uint32_t> lowest(o.parts, ~std::uint32_t{0});
  double volume = 0.0;
  for (std::size_t k = 0; k < sound.size(); ++k) {
    if (o.against[k])
      report.flipped.add(sound[k]);
    const double v = six_volumes(mesh, sound[k], about) / 6.0;
    volume += v;
    part_volume[o.part[k]] += o.against[k] ? -v : v;
    lowest[o.part[k]] = std::min(lowest[o.part[k]], sound[k]);
  }
  report.signed_volume_m3 = volume;
  report.inverted = report.closed && volume < 0.0;
  // If more than two triangles meet at an edge, a part may have a border there, and its volume is
  // meaningless.
  if (!report.closed || report.inverted || report.non_manifold_edges.count > 0)
    return;
  for (std::size_t p = 0; p < o.parts; ++p) {
    if (part_volume[p] < 0.0)
      report.inward_parts.add(lowest[p]);
  }
  if (o.parts < 2)
    return;
  std::vector<Part> parts(o.parts);
  for (std::size_t k = 0; k < sound.size(); ++k) {
    Part& part = parts[o.part[k]];
    part.lowest = lowest[o.part[k]];
    part.triangles.push_back(sound[k]);
    for (int corner = 0; corner < 3; ++corner)
      part.box.extend(mesh.corner(sound[k], corner));
  }
  find_nested(mesh, parts, part_volume, report);
}

/// "12 open edges (at triangles 3, 4, 7, 8, 9, ...)"
std::string counted(const Finding& f, const char* one, const char* many, std::string_view where) {
  const bool plural = f.examples.size() > 1,
             more = f.examples.size() == Finding::kExamples && f.count > f.examples.size();
  const std::string noun = !plural             ? std::string(where)
                           : where == "vertex" ? "vertices"
                                               : fmt::format("{}s", where);
  return fmt::format("{} {} ({} {}{})", f.count, f.count == 1 ? one : many, noun,
                     fmt::join(f.examples, ", "), more ? ", ..." : "");
}

}  // namespace

MeshReport inspect(const TriangleMesh& mesh) {
  MeshReport report;
  report.vertices = mesh.vertices.size();
  report.triangles = mesh.triangles.size();
  const std::vector<std::uint32_t> stands = standing_vertices(mesh, 0.0);
  count_vertices(mesh, stands, report);
  const std::vector<TriangleKind> kinds = triangle_kinds(mesh, stands);
  count_kinds(kinds, report);
  const std::vector<std::uint32_t> sound = of_kind(kinds, false);
  const std::vector<Side> sides = sorted_sides(mesh, stands, sound);
  count_edges(sides, report);
  report.open_edges = open_edges_of(sides);
  if (report.open_edges.count > 0 && report.zero_area.count > 0) {
    const Finding filled = open_edges_of(sorted_sides(mesh, stands, of_kind(kinds, true)));
    if (filled.count < report.open_edges.count)
      report.open_edges = filled;
  }
  report.closed =
      !sound.empty() && report.open_edges.count == 0 && report.not_finite_vertices.count == 0;
  judge_orientation(mesh, sides, sound, report);
  return report;
}

std::vector<std::string> MeshReport::sentences() const {
  std::vector<std::string> all;
  const auto say = [&](const Finding& f, const char* one, const char* many, const char* where,
                       const char* cost) {
    if (f.count > 0)
      all.push_back(counted(f, one, many, where) + cost);
  };
  say(not_finite_vertices, "vertex is not finite", "vertices are not finite", "vertex",
      ": the mesh cannot be built; repair the file");
  say(open_edges, "open edge", "open edges", "at triangle",
      ": the mesh has no interior; penalty forces do not push the tool back once it has passed the "
      "surface");
  if (inverted)
    all.push_back(
        "the whole mesh faces inward (negative volume): all triangles are treated as flipped; "
        "other programs may display it inside out");
  say(flipped, "triangle is oriented opposite to its neighbours",
      "triangles are oriented opposite to their neighbours", "triangle",
      closed && orientable
          ? ": treated as flipped"
          : ": normals there point the wrong way; the force drops or reverses there");
  say(inward_parts, "closed part faces inward", "closed parts face inward", "beginning at triangle",
      ": correct for a cavity inside another part; a separate part is treated as flipped");
  say(nested_parts, "closed part lies inside another with the same orientation",
      "closed parts lie inside another with the same orientation", "beginning at triangle",
      ": its interior is solid; for a cavity, flip its triangles");
  if (!orientable)
    all.push_back(
        "the surface is not orientable (like a Moebius band): normals and forces reverse "
        "somewhere");
  say(non_manifold_edges, "edge has more than two triangles", "edges have more than two triangles",
      "at triangle", ": shell points there average the normals of several sheets");
  say(zero_area, "triangle has no area", "triangles have no area", "triangle",
      ": kept without normal and weight; shell points of such triangles only have no area weight");
  say(duplicates, "triangle repeats an earlier one", "triangles repeat earlier ones", "triangle",
      ": shell points there have double area weight");
  say(opposite_duplicates, "triangle repeats an earlier one with opposite orientation",
      "triangles repeat earlier ones with opposite orientation", "triangle",
      ": their normals cancel; shell points there use the normal of one face");
  say(unused_vertices, "vertex is used by no triangle", "vertices are used by no triangle",
      "vertex", ": no effect");
  if (triangles > 0 && edges == 0 && not_finite_vertices.count == 0)
    all.push_back("no triangle has an area: the mesh has no contact");
  return all;
}

}  // namespace voxtouch::mesh

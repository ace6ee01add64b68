#include "fixtures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace voxtouch::test {
namespace {

const std::string kVectors = std::string(VOXTOUCH_TEST_DATA) + "/vectors/";

std::vector<std::vector<std::string>> read_csv(const std::string& file) {
  std::ifstream in(kVectors + file);
  if (!in)
    throw std::runtime_error("cannot read " + kVectors + file);
  std::vector<std::vector<std::string>> rows;
  std::string line, cell;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> row;
    std::stringstream cells(line);
    while (std::getline(cells, cell, ','))
      row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

Vec3 vec3(const std::vector<std::string>& row, std::size_t first) {
  return {std::stod(row.at(first)), std::stod(row.at(first + 1)), std::stod(row.at(first + 2))};
}

std::vector<std::uint32_t> parse_ids(const std::string& text) {
  std::vector<std::uint32_t> ids;
  std::stringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t dash = word.find('-');
    const auto first = static_cast<std::uint32_t>(std::stoul(word));
    const auto last = dash == std::string::npos
                          ? first
                          : static_cast<std::uint32_t>(std::stoul(word.substr(dash + 1)));
    for (std::uint32_t id = first; id <= last; ++id)
      ids.push_back(id);
  }
  return ids;
}

std::uint64_t spread(std::uint64_t v) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < 20; ++bit)
    out |= (v >> bit & 1U) << (3 * bit);
  return out;
}

void add_point(pointshell::Pointshell& shell, const Vec3& p, const Vec3& n) {
  shell.x.push_back(p.x()), shell.y.push_back(p.y()), shell.z.push_back(p.z());
  shell.nx.push_back(n.x()), shell.ny.push_back(n.y()), shell.nz.push_back(n.z());
  shell.area_m2.push_back(shell.edge * shell.edge);
  shell.coherence.push_back(1.0);
  shell.id.push_back(static_cast<std::uint32_t>(shell.id.size()));
}

}  // namespace

pointshell::Pointshell reordered(const pointshell::Pointshell& shell,
                                 const std::vector<std::uint32_t>& order) {
  pointshell::Pointshell out;
  out.edge = shell.edge;
  for (const std::uint32_t p : order) {
    add_point(out, shell.point(p), shell.normal(p));
    out.id.back() = shell.id[p];
  }
  return out;
}

pointshell::Pointshell morton_ordered(const pointshell::Pointshell& shell) {
  Vec3 low = Vec3::Constant(1e300);
  for (std::size_t p = 0; p < shell.size(); ++p)
    low = low.cwiseMin(shell.point(p));
  std::vector<std::uint64_t> key(shell.size());
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 u = (shell.point(p) - low) / shell.edge;
    key[p] = spread(static_cast<std::uint64_t>(u.x())) |
             spread(static_cast<std::uint64_t>(u.y())) << 1 |
             spread(static_cast<std::uint64_t>(u.z())) << 2;
  }
  std::vector<std::uint32_t> order(shell.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
  return reordered(shell, order);
}

VectorMesh load_vector_mesh(const std::string& name) {
  std::ifstream in(kVectors + "index.json");
  const nlohmann::json mesh = nlohmann::json::parse(in).at("meshes").at(name);
  voxmap::Grid grid;
  grid.edge = mesh.at("e").get<double>();
  for (int axis = 0; axis < 3; ++axis)
    grid.origin[axis] = mesh.at("origin").at(static_cast<std::size_t>(axis)).get<double>();
  const auto surface = read_csv("voxels/" + name + "_surface.csv");
  const auto index = [](const std::vector<std::string>& row) {
    return voxmap::VoxelIndex{std::stoi(row.at(0)), std::stoi(row.at(1)), std::stoi(row.at(2))};
  };
  voxmap::VoxelIndex first = index(surface.front()), last = first;
  for (const auto& row : surface) {
    const voxmap::VoxelIndex v = index(row);
    first = {std::min(first.i, v.i), std::min(first.j, v.j), std::min(first.k, v.k)};
    last = {std::max(last.i, v.i), std::max(last.j, v.j), std::max(last.k, v.k)};
  }
  VectorMesh out{voxmap::Voxmap(grid, first, last), {}, {}};
  out.exact.edge = out.naive.edge = grid.edge;
  for (const auto& row : surface) {
    out.voxmap.set(index(row), voxmap::VoxelKind::kSurface);
    add_point(out.exact, vec3(row, 4), vec3(row, 7));
    add_point(out.naive, grid.centre(index(row)), vec3(row, 7));
  }
  for (const auto& row : read_csv("voxels/" + name + "_interior.csv"))
    for (voxmap::VoxelIndex v = index(row); v.k <= std::stoi(row.at(3)); ++v.k)
      out.voxmap.set(v, voxmap::VoxelKind::kInterior);
  out.voxmap.finish();
  out.exact = morton_ordered(out.exact);
  out.naive = morton_ordered(out.naive);
  return out;
}

std::vector<VectorPose> load_vector_poses(const std::string& file) {
  std::vector<VectorPose> out;
  for (const auto& row : read_csv("poses/" + file)) {
    VectorPose& p = out.emplace_back();
    p.pose.orientation =
        Quat(std::stod(row.at(0)), std::stod(row.at(1)), std::stod(row.at(2)), std::stod(row.at(3)))
            .normalized();
    p.pose.position = vec3(row, 4);
    p.surface = static_cast<std::uint32_t>(std::stoul(row.at(7)));
    p.interior = static_cast<std::uint32_t>(std::stoul(row.at(8)));
    p.coherence = row.at(9);
    p.original = {vec3(row, 10), vec3(row, 13)};
    p.adapted = {vec3(row, 16), vec3(row, 19)};
    if (row.size() > 28)
      p.ids = parse_ids(row.at(28));
  }
  return out;
}

void add_block(voxmap::Voxmap& voxmap, const voxmap::VoxelIndex& first,
               const voxmap::VoxelIndex& last) {
  for (voxmap::VoxelIndex v = first; v.i <= last.i; ++v.i)
    for (v.j = first.j; v.j <= last.j; ++v.j)
      for (v.k = first.k; v.k <= last.k; ++v.k) {
        const bool inside = v.i > first.i && v.i < last.i && v.j > first.j && v.j < last.j &&
                            v.k > first.k && v.k < last.k;
        voxmap.set(v, inside ? voxmap::VoxelKind::kInterior : voxmap::VoxelKind::kSurface);
      }
}

voxmap::Voxmap block(const voxmap::Grid& grid, const voxmap::VoxelIndex& first,
                     const voxmap::VoxelIndex& last) {
  voxmap::Voxmap voxmap(grid, first, last);
  add_block(voxmap, first, last);
  voxmap.finish();
  return voxmap;
}

pointshell::Pointshell shell_of(const std::vector<std::pair<Vec3, Vec3>>& points_and_normals,
                                double edge_m) {
  pointshell::Pointshell shell;
  shell.edge = edge_m;
  for (const auto& [p, n] : points_and_normals)
    add_point(shell, p, n);
  return shell;
}

pointshell::Pointshell sphere_shell(double radius_m, double edge_m) {
  const double r = radius_m / edge_m;
  const int half = static_cast<int>(2.0 * std::numbers::pi * r * r);
  std::vector<std::pair<Vec3, Vec3>> points;
  for (int n = 0; n < half; ++n) {
    const double x = (n + 0.5) / half,
                 ring = std::sqrt(1.0 - x * x);  // equal areas in x > 0, then the mirror image
    const double angle = n * std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (const double side : {1.0, -1.0}) {
      const Vec3 out(side * x, ring * std::cos(angle), ring * std::sin(angle));
      points.emplace_back(radius_m * out, -out);
    }
  }
  return morton_ordered(shell_of(points, edge_m));
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

contact::Hits made_hits(const std::vector<contact::Hit>& hits, double edge_m) {
  static std::deque<std::array<std::vector<double>, 7>> kept;  // hits point into it
  const std::size_t points = hits.empty() ? 0 : hits.back().point + std::size_t{1};
  std::array<std::vector<double>, 7>& columns = kept.emplace_back();
  for (std::vector<double>& column : columns)
    column.resize(points);
  contact::HitSource source;
  source.edge = edge_m, source.area = columns[6].data();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    source.r[axis][axis] = 1.0, source.t[axis] = 0.5 * edge_m;
    source.place[axis] = columns[axis].data(), source.normal[axis] = columns[3 + axis].data();
  }
  contact::Hits out;
  std::uint32_t* number = out.room(hits.size());
  Vec3 normals = Vec3::Zero();
  double weights = 0.0;
  for (const contact::Hit& hit : hits) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns[axis][hit.point] = -hit.to_centre[static_cast<Eigen::Index>(axis)];
      columns[3 + axis][hit.point] = hit.normal[static_cast<Eigen::Index>(axis)];
    }
    columns[6][hit.point] = hit.weight;
    normals += hit.weight * hit.normal, weights += hit.weight;
    *number++ = hit.point;
  }
  out.keep(hits.size(), source);
  out.set_sums(normals, weights);
  return out;
}

Quat random_rotation(std::mt19937_64& random) {
  for (;;) {
    Quat q(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1),
           uniform(random, -1, 1));
    if (q.norm() > 0.1 && q.norm() < 1.0)
      return q.normalized();
  }
}

bool same_bits(const Wrench& a, const Wrench& b) {
  return std::memcmp(a.force.data(), b.force.data(), sizeof(double) * 3) == 0 &&
         std::memcmp(a.torque.data(), b.torque.data(), sizeof(double) * 3) == 0;
}

}  // namespace voxtouch::test

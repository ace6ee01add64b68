#pragma once
/// Readers for the reference vectors, and common shapes and loops of the tests of voxmap and
/// pointshell.
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::test {

inline const std::vector<std::string>& vector_meshes() {
  static const std::vector<std::string> names{"sphere", "slab_tilted", "cylinder",
                                              "lshape", "aligned_box", "degenerate_tris"};
  return names;
}

inline std::ifstream open_vector(const std::string& path) {
  std::ifstream in(std::string(VOXTOUCH_TEST_DATA "/vectors/") + path);
  if (!in)
    throw std::runtime_error("cannot open " + path);
  return in;
}

/// Vertices and triangles of a plain OBJ; that is all the vectors hold.
inline mesh::TriangleMesh read_obj(const std::string& name) {
  std::ifstream in = open_vector("meshes/" + name + ".obj");
  mesh::TriangleMesh mesh;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 x;
      words >> x.x() >> x.y() >> x.z();
      mesh.vertices.push_back(x);
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> t{};
      for (auto& v : t)
        words >> v, --v;
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

inline const nlohmann::json& vector_index() {
  static const nlohmann::json index = nlohmann::json::parse(open_vector("index.json"));
  return index;
}

inline voxmap::Grid vector_grid(const std::string& name) {
  const auto& entry = vector_index().at("meshes").at(name);
  return {Vec3(entry["origin"][0], entry["origin"][1], entry["origin"][2]),
          entry["e"].get<double>()};
}

/// Rows of a CSV file by column name.
inline std::vector<std::map<std::string, double>> read_csv(std::istream& in) {
  std::vector<std::map<std::string, double>> rows;
  std::vector<std::string> names;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::map<std::string, double> row;
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column)
      if (rows.empty() && row.empty() && names.size() == column &&
          !(std::isdigit(cell[0]) || cell[0] == '-'))
        names.push_back(cell);
      else
        row[names.at(column)] = std::stod(cell);
    if (!row.empty())
      rows.push_back(row);
  }
  return rows;
}

inline std::vector<voxmap::VoxelIndex> voxels_of(const voxmap::Voxmap& map,
                                                 voxmap::VoxelKind kind) {
  std::vector<voxmap::VoxelIndex> out;
  map.for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind k) {
    if (k == kind)
      out.push_back(v);
  });
  return out;
}

/// A loop that does its work in a fixed, scrambled order.
inline ParallelFor scrambled_for() {
  return [](std::size_t count, const std::function<void(std::size_t)>& body) {
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0; i < count; ++i)
      order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    for (const std::size_t i : order)
      body(i);
  };
}

inline mesh::TriangleMesh box(const Vec3& low, const Vec3& high) {
  mesh::TriangleMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.push_back(
        {n & 1 ? high.x() : low.x(), n & 2 ? high.y() : low.y(), n & 4 ? high.z() : low.z()});
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

/// A closed sphere of about 2 * n^2 triangles.
inline mesh::TriangleMesh sphere(const Vec3& centre, double radius, int n) {
  mesh::TriangleMesh mesh;
  mesh.vertices.push_back(centre + Vec3(0, 0, radius));
  for (int a = 1; a < n; ++a)
    for (int b = 0; b < n; ++b) {
      const double polar = std::numbers::pi * a / n, turn = 2 * std::numbers::pi * b / n;
      mesh.vertices.push_back(centre + radius * Vec3(std::sin(polar) * std::cos(turn),
                                                     std::sin(polar) * std::sin(turn),
                                                     std::cos(polar)));
    }
  mesh.vertices.push_back(centre - Vec3(0, 0, radius));
  const auto at = [n](int a, int b) { return static_cast<std::uint32_t>(1 + (a - 1) * n + b % n); };
  const auto south = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int b = 0; b < n; ++b) {
    mesh.triangles.push_back({0, at(1, b), at(1, b + 1)});
    for (int a = 1; a + 1 < n; ++a) {
      mesh.triangles.push_back({at(a, b), at(a + 1, b), at(a + 1, b + 1)});
      mesh.triangles.push_back({at(a, b), at(a + 1, b + 1), at(a, b + 1)});
    }
    mesh.triangles.push_back({south, at(n - 1, b + 1), at(n - 1, b)});
  }
  return mesh;
}

inline mesh::TriangleMesh flipped(mesh::TriangleMesh mesh) {
  for (auto& t : mesh.triangles)
    std::swap(t[1], t[2]);
  return mesh;
}

inline mesh::TriangleMesh joined(mesh::TriangleMesh a, const mesh::TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

inline mesh::TriangleMesh moved(mesh::TriangleMesh mesh, const Vec3& by, double scale = 1.0) {
  for (Vec3& x : mesh.vertices)
    x = scale * x + by;
  return mesh;
}

/// The mesh with 1000 zero-area, sliver, duplicate and opposite triangles that lie on its surface.
inline mesh::TriangleMesh littered(mesh::TriangleMesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t sound = mesh.triangles.size();
  for (int n = 0; n < 1000; ++n) {
    const auto t = mesh.triangles[random() % sound];
    const auto [a, b, c] = t;
    switch (n % 6) {
      case 0:
        mesh.triangles.push_back({a, a, b});
        break;
      case 1:
        mesh.triangles.push_back({c, c, c});
        break;
      case 2:
        mesh.triangles.push_back({b, c, a});
        break;
      case 3:
        mesh.triangles.push_back({a, c, b});
        break;
      case 4: {  // a copy of a corner: the same place under another number
        mesh.vertices.push_back(mesh.vertices[a]);
        mesh.triangles.push_back({static_cast<std::uint32_t>(mesh.vertices.size() - 1), b, a});
        break;
      }
      default: {  // the whole triangle again with separate vertices
        const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const std::uint32_t corner : {b, c, a})
          mesh.vertices.push_back(Vec3(mesh.vertices[corner]));
        mesh.triangles.push_back({v, v + 1, v + 2});
      }
    }
  }
  return mesh;
}

}  // namespace voxtouch::test

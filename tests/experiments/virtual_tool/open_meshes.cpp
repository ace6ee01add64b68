#include "open_meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "god_object.hpp"

namespace voxtouch::virtual_tool {
namespace {

constexpr double kWide = 0.08, kPi = std::numbers::pi;
constexpr std::array kShapes = {"sheet",   "fold:60", "fold:120", "tee",    "cross",
                                "lidless", "hole",    "tube",     "bowl",   "moebius",
                                "shards",  "fin",     "inverted", "doubled"};

/// The half of a sheet that begins at the x axis and lies `degrees` above the y axis.
void add_half(double degrees, mesh::TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const double angle = degrees * kPi / 180.0, half = 0.5 * kWide;
  const Vec3 out(0.0, half * std::cos(angle), half * std::sin(angle));
  mesh.vertices.insert(mesh.vertices.end(), {Vec3(-half, 0, 0), Vec3(half, 0, 0),
                                             Vec3(half, 0, 0) + out, Vec3(-half, 0, 0) + out});
  mesh.triangles.push_back({first, first + 1, first + 2}),
      mesh.triangles.push_back({first, first + 2, first + 3});
}

mesh::TriangleMesh halves(std::initializer_list<double> degrees) {
  mesh::TriangleMesh mesh;
  for (const double d : degrees)
    add_half(d, mesh);
  return mesh;
}

/// A strip of `count` pieces between pairs of vertices. It is closed, and flipped by `half_turns`.
mesh::TriangleMesh strip(std::uint32_t count, double half_turns) {
  mesh::TriangleMesh mesh;
  for (std::uint32_t n = 0; n < count; ++n)
    for (const double side : {-1.0, 1.0}) {
      const double angle = 2.0 * kPi * n / count, turn = 0.5 * half_turns * angle;
      const double out = 0.04 + 0.02 * side * std::sin(turn);
      mesh.vertices.emplace_back(out * std::cos(angle), out * std::sin(angle),
                                 0.02 * side * std::cos(turn));
    }
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint32_t a = 2 * n, b = a + 1;
    std::uint32_t c = 2 * ((n + 1) % count), d = c + 1;
    if (n + 1 == count && half_turns > 0.0)
      std::swap(c, d);
    mesh.triangles.push_back({a, c, d}), mesh.triangles.push_back({a, d, b});
  }
  return mesh;
}

mesh::TriangleMesh shards() {
  constexpr int kPieces = 12;
  mesh::TriangleMesh mesh;
  const auto add = [&](const std::array<Vec3, 3>& corners) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    for (const Vec3& c : corners)
      mesh.vertices.push_back(middle + 0.98 * (c - middle));
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  const auto at = [](int x, int y) {
    return Vec3(kWide * (x / double{kPieces} - 0.5), kWide * (y / double{kPieces} - 0.5), 0.0);
  };
  for (int x = 0; x < kPieces; ++x)
    for (int y = 0; y < kPieces; ++y)
      add({at(x, y), at(x + 1, y), at(x + 1, y + 1)}),
          add({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
  return mesh;
}

mesh::TriangleMesh without_last(mesh::TriangleMesh mesh, std::size_t triangles) {
  mesh.triangles.resize(mesh.triangles.size() - triangles);
  return mesh;
}

/// Edges that one triangle alone has, each as a triangle without area.
mesh::TriangleMesh rims_of(const mesh::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  mesh::TriangleMesh rims;
  for (const auto& [edge, count] : uses) {
    if (count > 1)
      continue;
    const auto first = static_cast<std::uint32_t>(rims.vertices.size());
    const Vec3 &a = mesh.vertices[edge.first], &b = mesh.vertices[edge.second];
    rims.vertices.insert(rims.vertices.end(), {a, b, 0.5 * (a + b)});
    rims.triangles.push_back({first, first + 1, first + 2});
  }
  return rims;
}

/// A box with its lid as the last two triangles, at +x.
mesh::TriangleMesh box() { return test::box_mesh(Vec3(0.06, 0.05, 0.05)); }

}  // namespace

std::span<const char* const> open_shapes() { return kShapes; }

mesh::TriangleMesh open_shape(const std::string& name) {
  if (name.starts_with("plate:"))
    return test::plate_mesh(kWide, std::stod(name.substr(6)));
  if (name == "sheet")
    return test::plate_mesh(kWide, 0.0);
  if (name.starts_with("fold:"))
    return halves({0.0, std::stod(name.substr(5))});
  if (name == "tee")
    return halves({0.0, 90.0, 180.0});
  if (name == "cross")
    return test::joined(
        halves({0.0, 180.0}),
        test::plate_mesh(kWide, 0.0, {Vec3::Zero(), Quat(Eigen::AngleAxisd(1.1, Vec3::UnitX()))}));
  if (name == "lidless")
    return without_last(box(), 2);
  if (name == "hole")
    return without_last(box(), 1);
  if (name == "inverted")
    return test::inside_out(box());
  if (name == "tube")
    return strip(48, 0.0);
  if (name == "moebius")
    return strip(48, 1.0);
  if (name == "shards")
    return shards();
  if (name == "fin")
    return test::joined(
        test::box_mesh(Vec3(0.06, 0.06, 0.02)),
        test::plate_mesh(0.04, 0.0,
                         {Vec3(0, 0, 0.03), Quat(Eigen::AngleAxisd(0.5 * kPi, Vec3::UnitX()))}));
  if (name == "bowl") {
    mesh::TriangleMesh mesh = test::sphere_mesh(0.035, 3);
    std::erase_if(mesh.triangles, [&](const auto& t) {
      return mesh.vertices[t[0]].z() + mesh.vertices[t[1]].z() + mesh.vertices[t[2]].z() > 0.0;
    });
    return mesh;
  }
  if (name == "doubled")
    return test::joined(test::plate_mesh(kWide, 0.0),
                        test::inside_out(test::plate_mesh(kWide, 0.0)));
  throw std::invalid_argument("no open shape is called '" + name + "'");
}

DriveFigures drive(const DriveOptions& o) {
  std::mt19937_64 random(o.seed);
  const double e = o.edge, radius = o.radius_edges * e;
  mesh::TriangleMesh mesh = open_shape(o.shape);
  const Pose lie{Vec3(0.37e-3, 0.11e-3, 0.23e-3), o.askew ? tilt() : Quat::Identity()};
  for (Vec3& v : mesh.vertices)
    v = lie * v;
  Rig rig(mesh, e, ball_mesh(radius));
  const mesh::TriangleMesh rim_mesh = rims_of(rig.mesh);
  const GodObject truth(rig.mesh, radius), rims(rim_mesh, radius);
  DriveFigures figures;
  std::vector<double> jitter;
  for (const double speed : o.edges_per_frame)
    for (int n = 0; n < o.tries; ++n) {
      Place place;
      Vec3 hand;
      Quat orientation;
      bool placed = false;
      for (int attempt = 0; attempt < 100 && !placed; ++attempt) {
        place = random_place("open:" + o.shape, rig.mesh, random);
        hand = place.point + (radius + uniform(random, 0.5, 3.0) * e) * place.normal;
        orientation = Quat(Eigen::AngleAxisd(uniform(random, 0, 3), random_direction(random)));
        placed = truth.distance(hand) > radius + 0.5 * e && rig.place({hand, orientation});
      }
      if (!placed)
        continue;
      ++figures.runs;
      double nearest = radius;
      bool at_rim = false;
      const auto step = [&](const Vec3& by) {
        hand += by;
        const exact::VirtualToolFrame frame = rig.frame(Pose{hand, orientation});
        if (const double near = truth.distance(frame.tool.position); near < nearest) {
          if (nearest > radius - e && near <= radius - e)
            at_rim = rims.distance(frame.tool.position) < near + e;
          nearest = near;
        }
        return frame.wrench(kStiffness).force;
      };
      const auto go = [&](const Vec3& displacement, double edges) {
        for (double gone = 0.0; gone < edges; gone += speed)
          step(speed * e * displacement);
      };
      const Vec3 in = (0.4 * random_direction(random) - place.normal).normalized(),
                 along = place.normal.cross(random_direction(random)).normalized();
      go(in, 2.0 * o.radius_edges + 4.0);
      go(along, 5.0);
      Vec3 force = Vec3::Zero();
      for (int rest = 0; rest < 600;
           ++rest)  // past a rim the tool moves on by a hundredth per frame
        force = step(Vec3::Zero());
      figures.touched += force.norm() > 0.0;
      double worst = 0.0;
      for (int rest = 0; rest < 30; ++rest) {
        const Vec3 next = step(Vec3::Zero());
        worst = std::max(worst, (next - force).norm());
        force = next;
      }
      jitter.push_back(worst);
      for (int displacement = 0; displacement < 3; ++displacement)
        go(random_direction(random), 12.0);
      if (nearest < 0.5 * radius)
        ++(at_rim ? figures.rims : figures.passed);
      figures.into_worst = std::max(figures.into_worst, (radius - nearest) / e);
    }
  if (!jitter.empty())
    figures.rest_95 = test::quantile(jitter, 0.95),
    figures.rest_worst = *std::max_element(jitter.begin(), jitter.end());
  return figures;
}

}  // namespace voxtouch::virtual_tool

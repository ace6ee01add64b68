#include "tests/support/exact_shapes/shapes.hpp"

#include <map>
#include <numbers>
#include <utility>

namespace voxtouch::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Builder {
  mesh::TriangleMesh mesh;
  std::uint32_t add(const Vec3& point) {
    mesh.vertices.push_back(point);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({a, b, c});
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
};

}  // namespace

mesh::TriangleMesh box(const Vec3& low, const Vec3& high) {
  Builder b;
  for (int k = 0; k < 8; ++k)
    b.add(
        {(k & 1) ? high.x() : low.x(), (k & 2) ? high.y() : low.y(), (k & 4) ? high.z() : low.z()});
  b.quad(0, 2, 3, 1);
  b.quad(4, 5, 7, 6);
  b.quad(0, 1, 5, 4);
  b.quad(2, 6, 7, 3);
  b.quad(0, 4, 6, 2);
  b.quad(1, 3, 7, 5);
  return b.mesh;
}

mesh::TriangleMesh ball(double radius, int levels) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  Builder b;
  for (const Vec3& v : {Vec3(-1, g, 0), Vec3(1, g, 0), Vec3(-1, -g, 0), Vec3(1, -g, 0),
                        Vec3(0, -1, g), Vec3(0, 1, g), Vec3(0, -1, -g), Vec3(0, 1, -g),
                        Vec3(g, 0, -1), Vec3(g, 0, 1), Vec3(-g, 0, -1), Vec3(-g, 0, 1)})
    b.add(v.normalized() * radius);
  const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (const auto& f : faces)
    b.triangle(static_cast<std::uint32_t>(f[0]), static_cast<std::uint32_t>(f[1]),
               static_cast<std::uint32_t>(f[2]));
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t p, std::uint32_t q) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(p, q), 0);
      if (fresh)
        at->second = b.add((b.mesh.vertices[p] + b.mesh.vertices[q]).normalized() * radius);
      return at->second;
    };
    const auto old = std::exchange(b.mesh.triangles, {});
    for (const auto& [p, q, r] : old) {
      const std::uint32_t pq = middle(p, q), qr = middle(q, r), rp = middle(r, p);
      b.triangle(p, pq, rp);
      b.triangle(q, qr, pq);
      b.triangle(r, rp, qr);
      b.triangle(pq, qr, rp);
    }
  }
  return b.mesh;
}

mesh::TriangleMesh sheet(double side, int n, bool t_junctions) {
  Builder b;
  const auto at = [&](double i, double j) {
    return b.add({side * (i / n - 0.5), side * (j / n - 0.5), 0.0});
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const std::uint32_t p = at(i, j), q = at(i + 1, j), r = at(i + 1, j + 1), s = at(i, j + 1);
      if (t_junctions && (i + j) % 2 == 1) {
        const std::uint32_t half =
            at(i + 1, j + 0.37);  // on the side that the next cell has in one piece
        b.triangle(p, q, half);
        b.triangle(p, half, r);
        b.triangle(p, r, s);
      } else {
        b.quad(p, q, r, s);
      }
    }
  }
  return b.mesh;
}

mesh::TriangleMesh prism(const Outline& outline, double z0, double z1) {
  Builder b;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {z0, z1})
    for (const auto& p : outline)
      b.add({p.x(), p.y(), z});
  const std::uint32_t low = b.add({0, 0, z0}), high = b.add({0, 0, z1});
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    b.quad(k, next, n + next, n + k);
    b.triangle(low, next, k);
    b.triangle(high, n + k, n + next);
  }
  return b.mesh;
}

mesh::TriangleMesh block_with_hole(const Outline& outline, double radius, double z0, double z1) {
  Builder b;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {z0, z1}) {
    for (const auto& p : outline)
      b.add({p.x(), p.y(), z});
    for (const auto& p : outline)
      b.add({p.x() / p.norm() * radius, p.y() / p.norm() * radius, z});
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n, up = 2 * n;
    b.quad(next, k, up + k, up + next);                    // the hole's wall, inward
    b.quad(n + k, n + next, up + n + next, up + n + k);    // outside
    b.quad(k, next, n + next, n + k);                      // bottom
    b.quad(up + k, up + n + k, up + n + next, up + next);  // top
  }
  return b.mesh;
}

mesh::TriangleMesh wedge(double angle, double depth, double half) {
  const double width = depth * std::tan(0.5 * angle);
  Builder b;
  for (const double y : {-half, half}) {
    b.add({0, y, 0});
    b.add({-width, y, -depth});
    b.add({width, y, -depth});
  }
  b.triangle(0, 1, 2);
  b.triangle(3, 5, 4);
  b.quad(0, 3, 4, 1);
  b.quad(0, 2, 5, 3);
  b.quad(1, 4, 5, 2);
  return b.mesh;
}

mesh::TriangleMesh bowl(double inner, double outer, int around, int down) {
  Builder b;
  std::vector<std::vector<std::uint32_t>> rings[2];
  for (int s = 0; s < 2; ++s) {
    for (int i = 0; i < down; ++i) {
      rings[s].emplace_back();
      const double polar = 0.5 * kPi * (1.0 + static_cast<double>(i) / down);
      for (int k = 0; k < around; ++k) {
        const double angle = 2.0 * kPi * k / around, r = s == 0 ? inner : outer;
        const double across = r * std::sin(polar);
        rings[s].back().push_back(
            b.add({across * std::cos(angle), across * std::sin(angle), r * std::cos(polar)}));
      }
    }
  }
  const std::uint32_t poles[2] = {b.add({0, 0, -inner}), b.add({0, 0, -outer})};
  for (std::size_t k = 0; k < static_cast<std::size_t>(around); ++k) {
    const std::size_t next = (k + 1) % static_cast<std::size_t>(around);
    for (std::size_t i = 0; i + 1 < static_cast<std::size_t>(down); ++i) {
      b.quad(rings[0][i][k], rings[0][i][next], rings[0][i + 1][next], rings[0][i + 1][k]);
      b.quad(rings[1][i][next], rings[1][i][k], rings[1][i + 1][k], rings[1][i + 1][next]);
    }
    b.triangle(rings[0].back()[k], rings[0].back()[next], poles[0]);
    b.triangle(rings[1].back()[next], rings[1].back()[k], poles[1]);
    b.quad(rings[0][0][next], rings[0][0][k], rings[1][0][k], rings[1][0][next]);
  }
  return b.mesh;
}

mesh::TriangleMesh terrain(double side, int n, double height) {
  Builder b;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      const double z = height * (std::sin(9.0 * x + 1.0) * std::cos(7.0 * y) +
                                 0.3 * std::sin(31.0 * x * y + 2.0 * y));
      b.add({side * (x - 0.5), side * (y - 0.5), z});
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      b.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  return b.mesh;
}

Outline circle(double radius, int n) {
  Outline out;
  for (int k = 0; k < n; ++k) {
    const double angle = 2.0 * kPi * k / n;
    out.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return out;
}

Outline grown(const Outline& outline, double grow) {
  Outline out;
  const std::size_t n = outline.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Vector2d before = (outline[k] - outline[(k + n - 1) % n]).normalized();
    const Eigen::Vector2d after = (outline[(k + 1) % n] - outline[k]).normalized();
    const Eigen::Vector2d out_before(before.y(), -before.x()), out_after(after.y(), -after.x());
    const double cosine = out_before.dot(out_after);
    out.push_back(outline[k] + grow / (1.0 + cosine) * (out_before + out_after));
  }
  return out;
}

Outline cross(double length, double width, double grow) {
  const Outline quarter{{length, -width}, {length, width}, {width, width}};
  Outline out;
  for (int k = 0; k < 4; ++k)
    for (const auto& p : quarter)
      out.push_back(Eigen::Rotation2Dd(0.5 * kPi * k) * p);
  return grown(out, grow);
}

namespace {

constexpr double kPitch = 0.0025, kMajor = 0.010;

/// ISO profile: crest an eighth of the pitch, flanks of 30 degrees, root a quarter; phase in turns.
double thread_radius(double phase) {
  const double depth = 0.625 * 0.5 * std::sqrt(3.0) * kPitch;
  const double from_crest = std::abs(phase - std::round(phase));
  return kMajor - depth * std::clamp((from_crest - 1.0 / 16) / (5.0 / 16), 0.0, 1.0);
}

/// Rows of `sides` vertices, a pitch / `sides` apart; its faces look outward.
mesh::TriangleMesh threaded(double length, double gap, int sides) {
  mesh::TriangleMesh out;
  const int half = static_cast<int>(std::lround(0.5 * length / kPitch * sides));
  for (int row = -half; row <= half; ++row) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * kPi * k / sides;
      const double radius = gap + thread_radius(static_cast<double>(row - k) / sides);
      out.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                row * kPitch / sides);
    }
  }
  const auto at = [&](int row, int k) {
    return static_cast<std::uint32_t>(row * sides + k % sides);
  };
  for (int row = 0; row < 2 * half; ++row) {
    for (int k = 0; k < sides; ++k) {
      out.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k + 1)});
      out.triangles.push_back({at(row, k), at(row + 1, k + 1), at(row + 1, k)});
    }
  }
  return out;
}

}  // namespace

mesh::TriangleMesh bolt(double length, int sides) {
  mesh::TriangleMesh out = threaded(length, 0.0, sides);
  const auto n = static_cast<std::uint32_t>(out.vertices.size());
  const auto round = static_cast<std::uint32_t>(sides);
  out.vertices.emplace_back(0.0, 0.0, -0.5 * length);
  out.vertices.emplace_back(0.0, 0.0, 0.5 * length);
  for (std::uint32_t k = 0; k < round; ++k) {
    const std::uint32_t next = (k + 1) % round;
    out.triangles.push_back({n, next, k});
    out.triangles.push_back({n + 1, n - round + k, n - round + next});
  }
  return out;
}

mesh::TriangleMesh nut(double length, double gap, int sides) {
  mesh::TriangleMesh out = turned_inside_out(threaded(length, gap, sides));
  const auto n = static_cast<std::uint32_t>(out.vertices.size());
  const auto round = static_cast<std::uint32_t>(sides);
  const Outline outer = circle(0.015, sides);
  for (const double z : {-0.5 * length, 0.5 * length})
    for (const auto& p : outer)
      out.vertices.emplace_back(p.x(), p.y(), z);
  for (std::uint32_t k = 0; k < round; ++k) {
    const std::uint32_t next = (k + 1) % round, top = n - round, low = n, high = n + round;
    for (const auto& triangle :
         std::initializer_list<std::array<std::uint32_t, 3>>{{low + k, low + next, high + next},
                                                             {low + k, high + next, high + k},
                                                             {k, next, low + next},
                                                             {k, low + next, low + k},
                                                             {top + next, top + k, high + k},
                                                             {top + next, high + k, high + next}})
      out.triangles.push_back(triangle);
  }
  return out;
}

Outline gear(int teeth, double root, double tip, double grow) {
  Outline out;
  for (int k = 0; k < teeth; ++k) {
    const double radii[4] = {root, tip, tip, root}, parts[4] = {0.0, 0.15, 0.45, 0.6};
    for (int j = 0; j < 4; ++j) {
      const double angle = 2.0 * kPi * (k + parts[j]) / teeth;
      out.emplace_back(radii[j] * std::cos(angle), radii[j] * std::sin(angle));
    }
  }
  return grown(out, grow);
}

mesh::TriangleMesh moved(const mesh::TriangleMesh& mesh, const Pose& pose) {
  mesh::TriangleMesh out = mesh;
  for (Vec3& vertex : out.vertices)
    vertex = pose * vertex;
  return out;
}

mesh::TriangleMesh joined(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
  mesh::TriangleMesh out = a;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [p, q, r] : b.triangles)
    out.triangles.push_back({first + p, first + q, first + r});
  return out;
}

mesh::TriangleMesh turned_inside_out(mesh::TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles)
    std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace voxtouch::test

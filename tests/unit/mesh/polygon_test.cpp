/// Polygons become triangles with the same boundary, the same area and no other corners.
#include "core/mesh/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/mesh/import.hpp"
#include "samples.hpp"
#include "tests/support/seed.hpp"

using namespace voxtouch;
using mesh::PolygonCutter;

namespace {

using Corners = std::vector<Vec3>;
using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Twice the area vector of a closed path.
Vec3 doubled_area(const Corners& path) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < path.size(); ++k) {
    sum += (path[k] - path[0]).cross(path[(k + 1) % path.size()] - path[0]);
  }
  return sum;
}

/// Net number of times each edge is traversed from the lower to the higher point.
class Chain {
 public:
  void walk(const Vec3& a, const Vec3& b) {
    const Place p = place(a), q = place(b);
    if (p == q)
      return;
    edges_[{std::min(p, q), std::max(p, q)}] += p < q ? 1 : -1;
  }
  bool operator==(const Chain& other) const { return walked() == other.walked(); }

 private:
  using Place = std::array<double, 3>;
  using Edges = std::map<std::pair<Place, Place>, int>;
  static Place place(const Vec3& x) { return {x.x(), x.y(), x.z()}; }
  Edges walked() const {
    Edges some = edges_;
    std::erase_if(some, [](const auto& edge) { return edge.second == 0; });
    return some;
  }
  Edges edges_;
};

constexpr double kExact = 1e-9;
/// Slivers between corners that were rounded to single precision lie to one side or to the other.
constexpr double kRounded = 5e-7;

/// `triangles`: how many there must be. `tolerance`: of the area, as a fraction.
void expect_cut(const Corners& polygon, std::size_t triangles, double tolerance = kExact) {
  static const PolygonCutter cutter;
  const auto cut = cutter.cut(polygon);
  ASSERT_TRUE(cut.has_value()) << "refused: " << polygon.size() << " corners";
  EXPECT_EQ(cut->size(), triangles);
  const Vec3 area = doubled_area(polygon);
  double sum = 0.0;
  Chain boundary, of_triangles;
  for (const auto& t : *cut) {
    const Corners own{polygon.at(t[0]), polygon.at(t[1]), polygon.at(t[2])};
    sum += area.norm() > 0.0 ? std::abs(doubled_area(own).dot(area.normalized())) : 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      of_triangles.walk(own[k], own[(k + 1) % 3]);
  }
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    boundary.walk(polygon[k], polygon[(k + 1) % polygon.size()]);
  }
  EXPECT_TRUE(boundary == of_triangles) << "another boundary";
  EXPECT_NEAR(sum, area.norm(), tolerance * area.norm()) << "another area";
}

void expect_crossing(const Corners& polygon) {
  EXPECT_FALSE(PolygonCutter().cut(polygon).has_value());
}

/// As numbers of single precision, which files hold.
Corners rounded(Corners corners) {
  for (Vec3& x : corners)
    x = x.cast<float>().cast<double>();
  return corners;
}

Corners turned(Corners corners, Random& random) {
  const Vec3 axis(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  const Quat turn(Eigen::AngleAxisd(uniform(random, 0, 6), axis.normalized()));
  for (Vec3& x : corners)
    x = turn * x;
  return corners;
}

/// Corners at random distances round the middle. Always simple, seldom convex.
Corners star(Random& random, std::size_t corners) {
  Corners path;
  for (std::size_t k = 0; k < corners; ++k) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(corners);
    path.emplace_back(uniform(random, 0.1, 1.0) * Vec3(std::cos(angle), std::sin(angle), 0));
  }
  return path;
}

/// Integers: up to a random height over each step, and back along the base. Steps of the same
/// height give collinear corners.
Corners staircase(Random& random, int steps) {
  Corners path;
  path.emplace_back(0, 0, 0);
  for (int k = 0; k <= steps; ++k)
    path.emplace_back(steps + k, 0, 0);
  for (int k = 0; k < steps; ++k) {
    const double height = 1.0 + static_cast<double>(random() % 3);
    path.emplace_back(2 * steps - k, height, 0);
    path.emplace_back(2 * steps - k - 1, height, 0);
  }
  path.emplace_back(0, 1, 0);
  return path;
}

/// More corners on the edges, at a half or a quarter of them, which is exact.
Corners with_collinear(const Corners& path, Random& random) {
  Corners more;
  for (std::size_t k = 0; k < path.size(); ++k) {
    more.push_back(path[k]);
    const Vec3& next = path[(k + 1) % path.size()];
    if (random() % 3 == 0)
      more.push_back(path[k] + 0.5 * (next - path[k]));
  }
  return more;
}

/// Some corners twice or three times in a row. `distinct`: how many corners are left without them.
Corners with_repeats(const Corners& path, Random& random, std::size_t& distinct) {
  Corners more;
  std::set<std::array<double, 3>> places;
  for (const Vec3& x : path) {
    more.insert(more.end(), random() % 4 == 0 ? 1 + random() % 3 : 1, x);
    places.insert({x.x(), x.y(), x.z()});
  }
  std::rotate(more.begin(), more.begin() + static_cast<std::ptrdiff_t>(random() % more.size()),
              more.end());
  distinct = places.size();
  return more;
}

TEST(Polygon, TenThousandStarsAndStaircasesKeepBoundaryAndArea) {
  Random random(static_cast<unsigned>(voxtouch::testing::seed(9)));
  for (int round = 0; round < 10'000; ++round) {
    const std::size_t size = 4 + random() % 30;
    Corners path = round % 2 == 0 ? star(random, size) : staircase(random, 1 + round % 12);
    if (round % 3 == 0)
      path = with_collinear(path, random);
    const bool rounds = round % 4 < 2;
    if (rounds)
      path = rounded(turned(path, random));
    std::size_t distinct = 0;
    path = with_repeats(path, random, distinct);
    expect_cut(path, distinct - 2, rounds ? kRounded : kExact);
    if (HasFailure())
      FAIL() << "round " << round;
  }
}

TEST(Polygon, HolesJoinedByBridgesStayOpen) {
  Random random(static_cast<unsigned>(voxtouch::testing::seed(10)));
  for (int round = 0; round < 1'000; ++round) {
    // Holes in the cells of a board: each is traversed in the opposite direction, from the first
    // corner and back.
    const int cells = 1 + round % 4;
    Corners path{{0, 0, 0}, {double(cells), 0, 0}, {double(cells), 1, 0}, {0, 1, 0}, {0, 0, 0}};
    std::size_t corners = 4;
    for (int c = 0; c < cells; ++c) {
      Corners hole = star(random, 3 + random() % 8);
      std::ranges::reverse(hole);
      for (Vec3& x : hole)
        x = 0.4 * x + Vec3(c + 0.5, 0.5, 0);
      corners += hole.size();
      path.insert(path.end(), hole.begin(), hole.end());
      path.push_back(hole.front());
      path.push_back(path.front());
    }
    path.pop_back();
    if (round % 2 == 0)
      path = rounded(turned(path, random));
    expect_cut(path, corners + 2 * static_cast<std::size_t>(cells) - 2,
               round % 2 == 0 ? kRounded : kExact);
    if (HasFailure())
      FAIL() << "round " << round;
  }
}

TEST(Polygon, AnLIsCutTheSameFromEachCorner) {
  const Corners l{{0, 0, 0}, {40, 0, 0}, {40, 10, 0}, {20, 10, 0}, {20, 20, 0}, {0, 20, 0}};
  for (std::size_t first = 0; first < l.size(); ++first) {
    Corners path = l;
    std::rotate(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
    expect_cut(path, 4);
    std::ranges::reverse(path);
    expect_cut(path, 4);
  }
}

TEST(Polygon, BentConcaveQuadsKeepTheirBoundary) {
  const Corners dart{{0, 0, 0}, {2, 1, 0.1}, {0, 2, 0}, {0.5, 1, 0.2}};
  for (std::size_t first = 0; first < 4; ++first) {
    Corners path = dart;
    std::rotate(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
    const auto cut = PolygonCutter().cut(path);
    ASSERT_TRUE(cut.has_value());
    ASSERT_EQ(cut->size(), 2U);
    const std::size_t inner = (3 + 4 - first) % 4;  // the diagonal that lies inside ends there
    for (const auto& t : *cut)
      EXPECT_TRUE(std::ranges::count(t, inner) == 1) << first;
  }
}

TEST(Polygon, LobesThatTouchInACornerAreAllKept) {
  // Two squares with a common corner, as one boundary; and a square hole that touches the outline.
  expect_cut(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}}, 4);
  expect_cut(
      {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}}, 6);
}

TEST(Polygon, AHoleBelongsToTheLobeAroundIt) {
  expect_cut({{0, 0, 0},
              {1, 0, 0},
              {1, 1, 0},
              {5, 1, 0},
              {5, 5, 0},
              {1, 5, 0},
              {1, 1, 0},
              {2, 2, 0},
              {2, 3, 0},
              {3, 3, 0},
              {3, 2, 0},
              {2, 2, 0},
              {1, 1, 0},
              {0, 1, 0}},
             10);
}

TEST(Polygon, SpikesKeepTheirEdgesAndAddNoArea) {
  expect_cut({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 4, 0}, {2, 2, 0}, {0, 2, 0}},
             2);                                                           // forth and back
  expect_cut({{0, 0, 0}, {2, 0, 0}, {2, 4, 0}, {2, 2, 0}, {0, 2, 0}}, 3);  // past a corner
}

TEST(Polygon, WithoutWidthIsAFanAndWithoutAreaNothing) {
  expect_cut({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}}, 2);
  EXPECT_TRUE(PolygonCutter().cut(Corners{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}})->empty());
  EXPECT_TRUE(PolygonCutter().cut(Corners(5, Vec3(1, 2, 3)))->empty());
}

TEST(Polygon, ThatCrossesItselfIsRefused) {
  expect_crossing({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});
  const auto crossing = PolygonCutter().cut(Corners{{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}});
  ASSERT_TRUE(!crossing && crossing.error().crossing);
  EXPECT_LT((*crossing.error().crossing - Vec3(0.75, 0.75, 0)).norm(), 1e-12);
  expect_crossing({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}, {1.5, 1, 0}});
  Corners pentagram;  // turns left at each corner
  for (int k = 0; k < 5; ++k)
    pentagram.emplace_back(std::cos(2.4 * k / 3 * std::numbers::pi),
                           std::sin(2.4 * k / 3 * std::numbers::pi), 0);
  expect_crossing(pentagram);
  // A hole outside of its outline, one that crosses it, and two that overlap.
  const Corners square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}};
  const auto with_hole = [&](Corners path, double x, double y) {
    for (const Vec3& corner :
         {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)}) {
      path.push_back(corner + Vec3(x, y, 0));
    }
    path.push_back(path.front());
    return path;
  };
  expect_crossing(with_hole(square, 5, 1));
  expect_crossing(with_hole(square, 3.5, 1));
  expect_crossing(with_hole(with_hole(square, 1, 1), 1.5, 1.5));
}

TEST(Polygon, OfAFileIsNamedIfItCrossesItself) {
  const samples::Folder folder;
  const auto path = folder.write(
      "t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\nf 1 3 2 4\n");
  try {
    mesh::import_mesh(path);
    FAIL() << "read";
  } catch (const mesh::MeshError& refused) {
    const std::string text = refused.what();
    for (const char* fact : {"polygon 3 of 3", "intersects itself", "4 corners"}) {
      EXPECT_NE(text.find(fact), std::string::npos) << text;
    }
  }
}

TEST(Polygon, OfAFileKeepsTheSolid) {
  const samples::Folder folder;
  for (int first = 0; first < 6; ++first) {
    std::string text;
    for (const char* y : {"0", "30"}) {
      for (const char* xz : {"0 0", "40 0", "40 10", "20 10", "20 20", "0 20"}) {
        const std::string both = xz;
        text +=
            "v " + both.substr(0, both.find(' ')) + " " + y + both.substr(both.find(' ')) + "\n";
      }
    }
    std::string front = "f", back = "f";
    for (int k = 0; k < 6; ++k)
      front += " " + std::to_string((first + k) % 6 + 1);
    for (int k = 0; k < 6; ++k)
      back += " " + std::to_string(12 - (first + k) % 6);
    text += front + "\n" + back + "\n";
    for (int k = 0; k < 6; ++k) {
      const int n = (k + 1) % 6;
      text += "f " + std::to_string(k + 1) + " " + std::to_string(k + 7) + " " +
              std::to_string(n + 7) + " " + std::to_string(n + 1) + "\n";
    }
    const mesh::ImportedMesh got = mesh::import_mesh(folder.write("l.obj", text));
    EXPECT_EQ(got.mesh.triangles.size(), 20U);
    EXPECT_TRUE(got.report.clean()) << first;
    EXPECT_NEAR(got.report.signed_volume_m3, 18000.0, 1e-9);
    double area = 0.0;  // a flap in empty air adds to it, and not to the volume
    for (std::size_t t = 0; t < got.mesh.triangles.size(); ++t) {
      const Vec3 a = got.mesh.corner(t, 0);
      area += 0.5 * (got.mesh.corner(t, 1) - a).cross(got.mesh.corner(t, 2) - a).norm();
    }
    EXPECT_NEAR(area, 2 * 600.0 + 30.0 * 120.0, 1e-9) << first;
  }
}

}  // namespace

// query_equality [POINTS [SEED]]: compares the query with doubles for that many points (1e9) in
// random poses, with the kernels of every kind of processor that this one supports. Hits must be
// bit-identical. Some 5 minutes for 1e9.
#include <fmt/core.h>

#include "core/contact/contact_query.hpp"
#include "core/contact/instructions.hpp"
#include "core/types/number.hpp"
#include "tests/support/reference_query.hpp"
#include "tests/unit/contact/fixtures.hpp"

int main(int argc, char** argv) {
  using namespace voxtouch;
  using test::uniform;
  const double expected = argc > 1 ? parse_number<double>(argv[1]).value_or(0.0) : 1e9;
  const auto seed = argc > 2 ? parse_number<std::uint64_t>(argv[2]).value_or(1) : std::uint64_t{1};
  std::mt19937_64 random(seed);
  double decided = 0.0, hits_seen = 0.0;
  while (decided < expected) {
    // Voxels of any size, grids up to 1e6 m away, tools of 1 to 100 voxels.
    const double e = std::pow(10.0, uniform(random, -5, 1)),
                 away = std::pow(10.0, uniform(random, -3, 6));
    const voxmap::Grid grid{
        away * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)), e};
    voxmap::Voxmap map(grid, {0, 0, 0}, {63, 63, 63});
    test::add_block(map, {0, 0, 0}, {63, 63, 6});
    test::add_block(map, {0, 0, 0}, {9, 63, 40});
    for (int n = 0; n < 2000; ++n) {
      const auto any = [&] { return static_cast<std::int32_t>(random() % 64); };
      map.set({any(), any(), any()},
              n % 2 == 0 ? voxmap::VoxelKind::kSurface : voxmap::VoxelKind::kInterior);
    }
    map.finish();
    const double reach = std::pow(10.0, uniform(random, 0, 2));
    std::vector<std::pair<Vec3, Vec3>> points;
    for (int n = 0; n < 2003; ++n)
      points.emplace_back(
          e * reach * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)),
          Vec3::UnitZ());
    const pointshell::Pointshell shell = test::morton_ordered(test::shell_of(points, e));
    const contact::ContactQuery query(map, shell);
    contact::HitList hits;
    hits.reserve(shell.size());
    for (int n = 0; n < 500; ++n) {
      const Vec3 u(uniform(random, -10, 74), uniform(random, -10, 74), uniform(random, -10, 74));
      const Pose pose{grid.origin + e * u, test::random_rotation(random)};
      query.find(pose, hits);
      const test::ReferenceHits reference = test::reference_hits(map, shell, hits.pose_WT);
      for (const auto kind : {contact::Instructions::kAny, contact::Instructions::kAvx2,
                              contact::Instructions::kAvx512}) {
        if (kind > contact::widest_instructions())
          break;
        contact::use_instructions(kind);
        query.find(pose, hits);
        if (test::same(hits.surface, reference.surface) &&
            test::same(hits.interior, reference.interior))
          continue;
        fmt::print(
            "not the same: seed {}, after {:.0f} points, e = {} m, reach {} voxels, kind of "
            "processor {}\n",
            seed, decided, e, reach, static_cast<int>(kind));
        return 1;
      }
      decided += static_cast<double>(shell.size());
      hits_seen += static_cast<double>(reference.surface.size() + reference.interior.size());
    }
  }
  fmt::print("{:.0f} points, {:.0f} of them hits: the same to the last bit (seed {})\n", decided,
             hits_seen, seed);
  return 0;
}

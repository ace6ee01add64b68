#pragma once
/// The query without its tree, in plain loops: each point is assigned to its voxel in single
/// precision and looked up; next to the voxels' faces doubles decide, so the hits are equal to
/// ours. It is the baseline for culling.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/geometry.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::bench {

/// Holds the map and the shell, which must outlive it.
class FlatQuery {
 public:
  FlatQuery(const voxmap::Voxmap& map, const pointshell::Pointshell& shell)
      : map_(map),
        shell_(shell) {
    const auto single = [](const std::vector<double>& from) {
      return std::vector<float>(from.begin(), from.end());
    };
    x_ = single(shell.x), y_ = single(shell.y), z_ = single(shell.z);
  }

  /// Numbers of the points in surface and interior voxels, in order, at `pose_WT`; returns how
  /// many.
  std::size_t find(const Pose& pose_WT, std::vector<std::uint32_t>& hits) const {
    hits.resize(x_.size());
    const double scale = 1.0 / map_.grid().edge;
    const Mat3 turn = scale * pose_WT.orientation.toRotationMatrix();
    const voxmap::VoxelIndex& base = map_.base();
    const Vec3 shift =
        scale * (pose_WT.position - map_.grid().origin) - Vec3(base.i, base.j, base.k);
    Motion m{};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        m.turn[3 * row + column] = static_cast<float>(turn(row, column));
      m.shift[row] = static_cast<float>(shift[row]);
    }
    return loop({map_, shell_, turn, shift}, m, map_.arrays(), map_.cells(), x_.data(), y_.data(),
                z_.data(), x_.size(), hits.data());
  }

 private:
  struct Decide {
    const voxmap::Voxmap& map;
    const pointshell::Pointshell& shell;
    Mat3 turn;
    Vec3 shift;
    bool operator()(std::size_t n) const {
      const Vec3 u = turn * Vec3(shell.x[n], shell.y[n], shell.z[n]) + shift;
      const auto voxel = [](double at, std::int32_t first) {
        return static_cast<std::int32_t>(std::floor(at)) + first;
      };
      return map.at({voxel(u.x(), map.base().i), voxel(u.y(), map.base().j),
                     voxel(u.z(), map.base().k)}) != voxmap::VoxelKind::kFree;
    }
  };
  struct Motion {
    float turn[9], shift[3];
  };

  /// [voxels]; single precision is off by less in a table of up to 512 voxels along each axis.
  static constexpr float kBand = 5e-4F;

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  __attribute__((target_clones("avx2", "default")))
#endif
  static std::size_t
  loop(const Decide& decide, const Motion& m, const voxmap::Voxmap::Arrays& map,
       const std::array<std::int64_t, 3>& cells, const float* px, const float* py, const float* pz,
       std::size_t count, std::uint32_t* hits) {
    constexpr std::size_t kBlock = 64;
    std::int32_t cell[kBlock], bit[kBlock], apart[kBlock];
    std::size_t found = 0;
    const auto last = [&](std::size_t axis) {
      return static_cast<std::int32_t>(8 * cells[axis]) - 1;
    };
    const std::int32_t ends[3] = {last(0), last(1), last(2)},
                       along[2] = {map.cells_along[0], map.cells_along[1]};
    for (std::size_t first = 0; first < count; first += kBlock) {
      const std::size_t many = std::min(kBlock, count - first);
      for (std::size_t k = 0; k < many; ++k) {
        const float x = px[first + k], y = py[first + k], z = pz[first + k];
        const float u = m.turn[0] * x + m.turn[1] * y + m.turn[2] * z + m.shift[0];
        const float v = m.turn[3] * x + m.turn[4] * y + m.turn[5] * z + m.shift[1];
        const float w = m.turn[6] * x + m.turn[7] * y + m.turn[8] * z + m.shift[2];
        // Truncation is correct above zero only: less than a voxel before the table would count as
        // its first voxel.
        const auto i8 = static_cast<std::int32_t>(u + 8.0F),
                   j8 = static_cast<std::int32_t>(v + 8.0F),
                   l8 = static_cast<std::int32_t>(w + 8.0F);
        const float fu = u + 8.0F - static_cast<float>(i8) - 0.5F,
                    fv = v + 8.0F - static_cast<float>(j8) - 0.5F,
                    fw = w + 8.0F - static_cast<float>(l8) - 0.5F;
        apart[k] = static_cast<std::int32_t>(std::max({std::abs(fu), std::abs(fv), std::abs(fw)}) >
                                             0.5F - kBand);
        const std::int32_t i = i8 - 8, j = j8 - 8, l = l8 - 8;
        const std::int32_t inside = ~((i | j | l | (ends[0] - i) | (ends[1] - j) | (ends[2] - l)) >>
                                      31);  // all bits, or none
        // The table's first cell is of its border, which is free.
        cell[k] = inside & ((i >> 3) + along[0] * ((j >> 3) + along[1] * (l >> 3)));
        bit[k] = 2 * ((i & 7) + 8 * ((j & 7) + 8 * (l & 7)));
      }
      for (std::size_t k = 0; k < many; ++k) {
        if (apart[k] != 0) {
          hits[found] = static_cast<std::uint32_t>(first + k);
          found += decide(first + k) ? 1 : 0;
          continue;
        }
        const std::int32_t number = map.table[cell[k]];
        if (number == voxmap::Voxmap::kFreeBrick)
          continue;
        const voxmap::Voxmap::Brick& brick = map.bricks[number];
        hits[found] = static_cast<std::uint32_t>(first + k);
        found +=
            ((brick[static_cast<std::size_t>(bit[k] >> 6)] >> (bit[k] & 63)) & 3U) != 0 ? 1 : 0;
      }
    }
    return found;
  }

  const voxmap::Voxmap& map_;
  const pointshell::Pointshell& shell_;
  std::vector<float> x_, y_, z_;
};

}  // namespace voxtouch::bench

#include "core/voxmap/voxel_groups.hpp"

#include <bit>
#include <numeric>

namespace voxtouch::voxmap {
namespace {

constexpr std::size_t kBricksPerJob = 256;

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t root(std::uint32_t n) noexcept {
    for (; parent_[n] != n; n = parent_[n])
      parent_[n] = parent_[parent_[n]];
    return n;
  }
  void join(std::uint32_t a, std::uint32_t b) noexcept {
    a = root(a), b = root(b);
    if (a < b)
      parent_[b] = a;
    if (b < a)
      parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<BrickMask> split(const BrickMask& surface) {
  BrickMask room;
  for (std::size_t z = 0; z < 8; ++z)
    room[z] = ~surface[z];
  std::vector<BrickMask> pieces;
  for (std::size_t z = 0; z < 8; ++z)
    while (room[z] != 0) {
      BrickMask seed{};
      seed[z] = room[z] & (~room[z] + 1);
      const BrickMask piece = grow(seed, room);
      for (std::size_t s = 0; s < 8; ++s)
        room[s] &= ~piece[s];
      pieces.push_back(piece);
    }
  return pieces;
}

VoxelIndex first_of(const GroupPiece& piece, const SurfaceBits& surface) {
  VoxelIndex v = surface.first_voxel(piece.cell);
  for (int z = 0; z < 8; ++z)
    if (const std::uint64_t word = piece.voxels[static_cast<std::size_t>(z)]; word != 0) {
      const int bit = std::countr_zero(word);
      return {v.i + (bit & 7), v.j + (bit >> 3), v.k + z};
    }
  return v;
}

void split_bricks(const SurfaceBits& surface, const ParallelFor& parallel_for,
                  VoxelGroups& groups) {
  std::vector<std::size_t> cell_of(surface.bricks.size());
  for (std::size_t c = 0; c < surface.brick_of.size(); ++c)
    if (surface.brick_of[c] >= 0)
      cell_of[static_cast<std::size_t>(surface.brick_of[c])] = c;
  const std::size_t jobs = (surface.bricks.size() + kBricksPerJob - 1) / kBricksPerJob;
  std::vector<std::vector<GroupPiece>> found(jobs);
  std::vector<std::uint32_t> count(surface.bricks.size() + 1, 0);
  parallel_for(jobs, [&](std::size_t job) {
    for (std::size_t b = job * kBricksPerJob;
         b < std::min((job + 1) * kBricksPerJob, surface.bricks.size()); ++b) {
      for (const BrickMask& piece : split(surface.bricks[b])) {
        found[job].push_back({cell_of[b], piece});
        ++count[b + 1];
      }
    }
  });
  std::partial_sum(count.begin(), count.end(), count.begin());
  groups.first_piece = std::move(count);
  groups.pieces.reserve(groups.first_piece.back());
  for (auto& part : found) {
    groups.pieces.insert(groups.pieces.end(), part.begin(), part.end());
    std::vector<GroupPiece>().swap(part);
  }
}

/// Joins groups that touch across a face. Nodes of `sets`: the cells, then the pieces of bricks.
void join_cells(const SurfaceBits& surface, const VoxelGroups& groups, UnionFind& sets) {
  const std::size_t cells = surface.brick_of.size();
  // Calls f(node, face bits) for every group on one face of a cell.
  const auto on_face = [&](std::size_t cell, int axis, int side, auto&& f) {
    const std::int32_t brick = surface.brick_of[cell];
    if (brick < 0)
      return f(static_cast<std::uint32_t>(cell), ~std::uint64_t{0});
    for (std::uint32_t p = groups.first_piece[static_cast<std::size_t>(brick)];
         p < groups.first_piece[static_cast<std::size_t>(brick) + 1]; ++p)
      if (const std::uint64_t bits = face(groups.pieces[p].voxels, axis, side); bits != 0)
        f(static_cast<std::uint32_t>(cells + p), bits);
  };
  const auto join_across = [&](std::size_t low, std::size_t high, int axis) {
    if (surface.brick_of[low] < 0 && surface.brick_of[high] < 0)
      return sets.join(static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high));
    on_face(low, axis, 1, [&](std::uint32_t a, std::uint64_t a_bits) {
      on_face(high, axis, 0, [&](std::uint32_t b, std::uint64_t b_bits) {
        if ((a_bits & b_bits) != 0)
          sets.join(a, b);
      });
    });
  };
  const auto ny = static_cast<std::size_t>(surface.cells[1]),
             nz = static_cast<std::size_t>(surface.cells[2]);
  std::size_t cell = 0;
  for (std::int64_t x = 0; x < surface.cells[0]; ++x)
    for (std::size_t y = 0; y < ny; ++y)
      for (std::size_t z = 0; z < nz; ++z, ++cell) {
        if (z > 0)
          join_across(cell - 1, cell, 2);
        if (y > 0)
          join_across(cell - nz, cell, 1);
        if (x > 0)
          join_across(cell - ny * nz, cell, 0);
      }
}

/// In order of their lowest node. Node 0 is a cell of the border, so group 0 is the outside.
void number_groups(const SurfaceBits& surface, UnionFind& sets, VoxelGroups& groups) {
  const std::size_t cells = surface.brick_of.size();
  groups.group.assign(cells + groups.pieces.size(), 0);
  for (std::uint32_t node = 0; node < groups.group.size(); ++node) {
    if (node < cells && surface.brick_of[node] >= 0)
      continue;
    const std::uint32_t root = sets.root(node);
    if (root != node) {
      groups.group[node] = groups.group[root];
      continue;
    }
    groups.group[node] = static_cast<std::uint32_t>(groups.representative.size());
    groups.representative.push_back(node < cells ? surface.first_voxel(node)
                                                 : first_of(groups.pieces[node - cells], surface));
  }
}

}  // namespace

VoxelGroups group_voxels(const SurfaceBits& surface, const ParallelFor& parallel_for) {
  VoxelGroups groups;
  split_bricks(surface, parallel_for, groups);
  UnionFind sets(surface.brick_of.size() + groups.pieces.size());
  join_cells(surface, groups, sets);
  number_groups(surface, sets, groups);
  return groups;
}

}  // namespace voxtouch::voxmap

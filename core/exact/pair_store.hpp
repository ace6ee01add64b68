#pragma once
/// Memory for the pair lists of all elements of a tool: blocks of a few pairs, each in one list or
/// free.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/exact/pair_probe.hpp"

namespace voxtouch::exact {

/// The constructor allocates all memory; all else is real-time safe.
class PairStore {
 public:
  static constexpr std::size_t kBlockPairs = 7;

  /// The paths come first because they are read most often.
  struct Block {
    std::array<double, kBlockPairs> touches_m{};  ///< path up to which the pair does not touch
    std::uint32_t count = 0, next = kNone;
    std::array<std::uint32_t, kBlockPairs> items{};
    std::array<SeparatingPlane, kBlockPairs> planes{};
  };

  PairStore(std::size_t elements, std::size_t blocks) : heads_(elements, kNone), blocks_(blocks) {
    reset();
  }

  std::size_t bytes() const noexcept {
    return heads_.size() * sizeof(std::uint32_t) + blocks_.size() * sizeof(Block);
  }

  /// Empties all lists.
  void reset() noexcept {
    std::fill(heads_.begin(), heads_.end(), kNone);
    for (std::size_t k = 0; k < blocks_.size(); ++k)
      blocks_[k].next = k + 1 < blocks_.size() ? static_cast<std::uint32_t>(k + 1) : kNone;
    free_ = blocks_.empty() ? kNone : 0;
  }

  /// Calls `visit` with each block of an element's list.
  template <class Visit>
  void for_blocks(std::uint32_t element, Visit&& visit) noexcept {
    for (std::uint32_t b = heads_[element]; b != kNone; b = blocks_[b].next)
      visit(blocks_[b]);
  }

  /// Whether there is room for a list of `pairs` pairs, if it replaces the element's list.
  bool has_room(std::size_t pairs, std::uint32_t element) const noexcept {
    const std::size_t requested = blocks_for(pairs);
    std::size_t found = 0;
    for (std::uint32_t b = heads_[element]; b != kNone && found < requested; b = blocks_[b].next)
      ++found;
    for (std::uint32_t b = free_; b != kNone && found < requested; b = blocks_[b].next)
      ++found;
    return found >= requested;
  }

  /// Replaces the element's list by `pairs` pairs, for which there must be room. `write(block, k,
  /// n)` writes pair n to index k of a block.
  template <class Write>
  void replace(std::uint32_t element, std::size_t pairs, Write&& write) noexcept {
    clear(element);
    for (std::size_t first = 0; first < pairs; first += kBlockPairs) {
      const std::uint32_t taken = free_;
      Block& block = blocks_[taken];
      free_ = block.next;
      block.count = static_cast<std::uint32_t>(std::min(kBlockPairs, pairs - first));
      for (std::size_t k = 0; k < block.count; ++k)
        write(block, k, first + k);
      block.next = heads_[element];
      heads_[element] = taken;
    }
  }

  void clear(std::uint32_t element) noexcept {
    while (heads_[element] != kNone) {
      Block& block = blocks_[heads_[element]];
      const std::uint32_t next = block.next;
      block.next = free_;
      free_ = heads_[element];
      heads_[element] = next;
    }
  }

 private:
  static std::size_t blocks_for(std::size_t pairs) noexcept {
    return (pairs + kBlockPairs - 1) / kBlockPairs;
  }

  std::vector<std::uint32_t> heads_;  ///< first block of each element's list
  std::vector<Block> blocks_;
  std::uint32_t free_ = kNone;
};

}  // namespace voxtouch::exact

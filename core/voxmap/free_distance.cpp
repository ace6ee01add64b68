#include "core/voxmap/free_distance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/types/clones.hpp"

// Lengths are in halves of cells. The centre of a cell n is then the lattice point 2 n + 1, and the
// gap from there to the cell i is an integer: i - (2 n + 1) above it, 2 n - i below. The squared
// distance is separable: the minimum along z first, then over rows along y, then over planes along
// x.
namespace voxtouch::voxmap::free_distance {
namespace {

using Squared = std::int16_t;
constexpr int kReach = 32;  ///< [halves of cells] exact up to here
constexpr Squared kFar = 3 * kReach * kReach;

constexpr int gap_to(std::int64_t centre, std::int64_t cell) {
  return static_cast<int>(cell > 2 * centre ? cell - (2 * centre + 1) : 2 * centre - cell);
}

/// best[n] = min(best[n], from[n] + more)
VOXTOUCH_CLONES void keep_nearer(Squared* best, const Squared* from, Squared more,
                                 std::size_t count) noexcept {
  for (std::size_t n = 0; n < count; ++n) {
    const auto distance = static_cast<Squared>(from[n] + more);
    best[n] = distance < best[n] ? distance : best[n];
  }
}

/// The minimum over the 26 neighbours and itself in two sweeps: exact for the chessboard distance,
/// in cells, saturated at 255.
class Chessboard {
 public:
  explicit Chessboard(const std::array<std::int64_t, 3>& n)
      : n_(n),
        bytes_(static_cast<std::size_t>(n[0] * n[1] * n[2]), kFarthest) {}

  std::uint8_t* row(std::int64_t x, std::int64_t y) noexcept {
    return &bytes_[static_cast<std::size_t>((x * n_[1] + y) * n_[2])];
  }

  void spread() {
    best_.assign(static_cast<std::size_t>(n_[2]) + 2, kFarthest);
    for (std::int64_t x = 0; x < n_[0]; ++x)
      for (std::int64_t y = 0; y < n_[1]; ++y)
        sweep(x, y, 1);
    for (std::int64_t x = n_[0]; x-- > 0;)
      for (std::int64_t y = n_[1]; y-- > 0;)
        sweep(x, y, -1);
  }
  std::vector<std::uint8_t>& bytes() noexcept { return bytes_; }

 private:
  static constexpr std::uint8_t kFarthest = 255;
  static std::uint8_t farther(std::uint8_t d) noexcept {
    return d == kFarthest ? d : static_cast<std::uint8_t>(d + 1);
  }

  void keep_least_of(std::int64_t x, std::int64_t y) noexcept {
    if (x < 0 || x >= n_[0] || y < 0 || y >= n_[1])
      return;
    const std::uint8_t* const from = row(x, y);
    for (std::size_t z = 0; z + 2 < best_.size(); ++z)
      best_[z + 1] = std::min(best_[z + 1], from[z]);
  }

  void sweep(std::int64_t x, std::int64_t y, int step) noexcept {
    const std::size_t line = best_.size() - 2;
    std::fill(best_.begin(), best_.end(),
              kFarthest);  // of the lines already swept; one cell of margin at each end
    for (int dy = -1; dy <= 1; ++dy)
      keep_least_of(x - step, y + dy);
    keep_least_of(x, y - step);
    std::uint8_t* const own = row(x, y);
    for (std::size_t z = 0; z < line; ++z)
      own[z] = std::min(own[z], farther(std::min(best_[z], std::min(best_[z + 1], best_[z + 2]))));
    if (step > 0)
      for (std::size_t z = 1; z < line; ++z)
        own[z] = std::min(own[z], farther(own[z - 1]));
    else
      for (std::size_t z = line - 1; z-- > 0;)
        own[z] = std::min(own[z], farther(own[z + 1]));
  }

  std::array<std::int64_t, 3> n_;
  std::vector<std::uint8_t> bytes_, best_;
};

std::array<std::uint8_t, kReach * kReach> fine_bytes() {
  std::array<std::uint8_t, kReach * kReach> out{};
  for (std::size_t n = 0; n < out.size(); ++n)
    out[n] = byte_of(2.0 * std::sqrt(static_cast<double>(n)));
  return out;
}

/// Beyond the fine range. `cells`: chessboard distance; its boxes are (cells - 1) * 4 steps apart,
/// and the centre is 2 more away.
std::uint8_t coarse_byte(std::uint8_t cells) noexcept {
  return byte_of(std::max(2.0 * kReach, (cells - 1.0) * kCellEdge + 2.0));
}

}  // namespace

Occupancy::Occupancy(const std::array<std::int64_t, 3>& bricks, int shift)
    : halvings_(shift - kMinShift),
      n_{2 * cells_along(bricks[0], shift), 2 * cells_along(bricks[1], shift),
         2 * cells_along(bricks[2], shift)},
      words_((n_[2] + 63) >> 6),
      bits_(static_cast<std::size_t>(n_[0] * n_[1] * words_)) {}

/// One plane x after the other: the minimum along z and y within it, for every centre. Only planes
/// within reach of some centre are kept.
class Occupancy::Planes {
 public:
  Planes(const Occupancy& from, std::int64_t centres_y, std::int64_t centres_z)
      : from_(from),
        ny_(centres_y),
        nz_(static_cast<std::size_t>(centres_z)),
        along_z_(static_cast<std::size_t>(from.n_[1]) * nz_),
        row_is_near_(static_cast<std::size_t>(from.n_[1])) {
    for (Plane& plane : ring_)
      plane.best.resize(static_cast<std::size_t>(ny_) * nz_),
          plane.near.resize(static_cast<std::size_t>(ny_));
  }

  /// best[z] = min over the plane `x`, row of the centre `y`, with `more` added. Returns false if
  /// nothing is near.
  bool lower(std::int64_t x, std::int64_t y, Squared more, Squared* best) {
    Plane& plane = ring_[static_cast<std::size_t>(x) % ring_.size()];
    if (plane.x != x)
      fill(plane, x);
    if (plane.near[static_cast<std::size_t>(y)] == 0)
      return false;
    keep_nearer(best, &plane.best[static_cast<std::size_t>(y) * nz_], more, nz_);
    return true;
  }

 private:
  struct Plane {
    std::int64_t x = -1;
    std::vector<Squared> best;       ///< centres (y, z)
    std::vector<std::uint8_t> near;  ///< y: whether anything is near
  };

  void fill(Plane& plane, std::int64_t x) {
    plane.x = x;
    for (std::int64_t y = 0; y < from_.n_[1]; ++y)
      row_is_near_[static_cast<std::size_t>(y)] = line(x, y);
    for (std::int64_t y = 0; y < ny_; ++y) {
      Squared* const best = &plane.best[static_cast<std::size_t>(y) * nz_];
      std::fill(best, best + nz_, kFar);
      std::uint8_t& near = plane.near[static_cast<std::size_t>(y)];
      near = 0;
      const std::int64_t last = std::min(from_.n_[1], 2 * y + 1 + kReach);
      for (std::int64_t row = std::max<std::int64_t>(0, 2 * y + 1 - kReach); row < last; ++row) {
        if (row_is_near_[static_cast<std::size_t>(row)] == 0)
          continue;
        const int gap = gap_to(y, row);
        keep_nearer(best, &along_z_[static_cast<std::size_t>(row) * nz_],
                    static_cast<Squared>(gap * gap), nz_);
        near = 1;
      }
    }
  }

  /// The row's own minimum for every centre: one pass up, one down. Returns false for an empty row.
  std::uint8_t line(std::int64_t x, std::int64_t y) {
    const std::uint64_t* const words =
        &from_.bits_[static_cast<std::size_t>((x * from_.n_[1] + y) * from_.words_)];
    std::uint64_t any = 0;
    for (std::int64_t w = 0; w < from_.words_; ++w)
      any |= words[w];
    if (any == 0)
      return 0;
    const auto pair = [&](std::size_t n) {
      return (words[n >> 5] >> (2 * (n & 31))) & 3U;
    };  // the centre's two cells
    Squared* const best = &along_z_[static_cast<std::size_t>(y) * nz_];
    int gap = kReach;
    for (std::size_t n = 0; n < nz_; ++n) {  // to the last cell below
      const auto cells = pair(n);
      gap = (cells & 1U) != 0 ? 0 : std::min(gap, kReach);
      best[n] = static_cast<Squared>(gap);
      gap = (cells & 2U) != 0 ? 1 : gap + 2;
    }
    gap = kReach;
    for (std::size_t n = nz_; n-- > 0;) {  // to the first above
      const auto cells = pair(n);
      gap = (cells & 2U) != 0 ? 0 : std::min(gap, kReach);
      const int nearest = std::min<int>(gap, best[n]);
      best[n] = static_cast<Squared>(nearest * nearest);
      gap = (cells & 1U) != 0 ? 1 : gap + 2;
    }
    return 1;
  }

  const Occupancy& from_;
  std::int64_t ny_;
  std::size_t nz_;
  std::vector<Squared> along_z_;
  std::vector<std::uint8_t> row_is_near_;
  std::array<Plane, static_cast<std::size_t>(2) * kReach> ring_;
};

std::vector<std::uint8_t> Occupancy::bytes() const {
  const std::array<std::int64_t, 3> n = {n_[0] / 2, n_[1] / 2, n_[2] / 2};
  Chessboard board(n);
  for (std::int64_t x = 0; x < n_[0]; ++x)
    for (std::int64_t y = 0; y < n_[1]; ++y) {
      const std::uint64_t* const words = &bits_[static_cast<std::size_t>((x * n_[1] + y) * words_)];
      std::uint8_t* const row = board.row(x / 2, y / 2);
      for (std::int64_t z = 0; z < n[2]; ++z)
        if (((words[z >> 5] >> (2 * (z & 31))) & 3U) != 0)
          row[z] = 0;
    }
  board.spread();

  static const auto kFine = fine_bytes();
  const auto nz = static_cast<std::size_t>(n[2]);
  Planes planes(*this, n[1], n[2]);
  std::vector<Squared> best(nz);
  for (std::int64_t x = 0; x < n[0]; ++x)
    for (std::int64_t y = 0; y < n[1]; ++y) {
      std::fill(best.begin(), best.end(), kFar);
      bool near = false;
      const std::int64_t last = std::min(n_[0], 2 * x + 1 + kReach);
      for (std::int64_t plane = std::max<std::int64_t>(0, 2 * x + 1 - kReach); plane < last;
           ++plane) {
        const int gap = gap_to(x, plane);
        near |= planes.lower(plane, y, static_cast<Squared>(gap * gap), best.data());
      }
      std::uint8_t* const row = board.row(x, y);
      for (std::size_t z = 0; z < nz; ++z)
        row[z] = near && best[z] < kReach * kReach ? kFine[static_cast<std::size_t>(best[z])]
                                                   : coarse_byte(row[z]);
    }
  board.bytes().resize((board.bytes().size() + 3) / 4 * 4);  // padded as in bytes_of
  return std::move(board.bytes());
}

}  // namespace voxtouch::voxmap::free_distance

#pragma once
/// The colliding points of one frame, what every contact model reads.
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::contact {

/// Whether a pose could be looked up at all. Anything but kUsable comes with no hits and no force.
enum class PoseStatus : std::uint8_t {
  kUsable = 0,
  kNotAPose = 1,    ///< NaN, Inf, or a quaternion norm outside [1e-3, 1e3]
  kOutOfRange = 2,  ///< so far from the grid that voxel indices leave int32
};

/// Adds the ascending list `from` to the ascending list `into`. Real-time safe where there is room.
template <class Vector, class Less>
void merge_ascending(const Vector& from, Vector& into, Less&& less) {
  std::size_t a = into.size(), b = from.size(), to = a + b;
  into.resize(to);
  while (b > 0)
    into[--to] = a > 0 && less(from[b - 1], into[a - 1]) ? into[--a] : from[--b];
}

/// One colliding point of a frame.
struct Hit {
  std::uint32_t point = 0;        ///< index into the pointshell's arrays
  Vec3 arm = Vec3::Zero();        ///< from the tool's origin to the point, W axes [m]
  Vec3 normal = Vec3::Zero();     ///< inward normal, W axes
  Vec3 to_centre = Vec3::Zero();  ///< from the point to its voxel's centre, W axes [m]
  double weight = 1.0;            ///< w_i: 1, or the point's area [m^2]; see PointWeights
};

/// A vector that does not write what it grows by: memory that no hit has reached yet is not
/// touched.
template <class T>
struct Unwritten : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Unwritten<U>;
  };
  template <class U>
  void construct(U* place) noexcept {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
};

/// The three products of a row of a rotation with a vector, added as Eigen adds them in a matrix
/// times a vector: the first two rows from the left, the last from the right. Kernels keep to it,
/// so that every model sees bit-identical values.
inline double row_sum(std::size_t row, double x, double y, double z) noexcept {
  return row < 2 ? x + y + z : x + (y + z);
}

/// The pose and the points in single precision, as the query decides with them (query_kernel.hpp):
/// enough to determine which hits surely do not push.
struct RoughSource {
  float a[3][3] = {};                     ///< as QueryFrame's
  float shift[3] = {};                    ///< likewise
  float certain = -1.0F;                  ///< likewise; below zero: nothing is certain
  const float* place[3] = {};             ///< of the shell's points, frame T [m]
  const std::uint32_t* normal = nullptr;  ///< packed_normals.hpp; null: they cannot be packed
};

/// Where the tool is, and what it is made of: with it a point's number is all that a hit is. The
/// shell must outlive it.
struct HitSource {
  double r[3][3] = {};           ///< rotation of T in W
  double t[3] = {};              ///< tool's origin from the grid's [m]
  double edge = 1.0;             ///< voxel edge e [m]
  const double* place[3] = {};   ///< of the shell's points, frame T [m]
  const double* normal[3] = {};  ///< likewise
  const double* area = nullptr;  ///< likewise; null: a point weighs 1
  RoughSource rough;

  /// The point as a hit, in doubles and always in this order, so that it is bit-identical whenever
  /// it is requested.
  Hit hit(std::uint32_t point) const noexcept;
};

/// Hits in ascending order of their points: `for (const Hit& hit : hits)`. Only the points' numbers
/// are kept; what a hit says is worked out when it is looked at, which costs less than to write it
/// down and read it again.
class Hits {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Hit;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = Hit;
    Iterator(const Hits& hits, std::size_t n) noexcept : hits_(&hits), n_(n) {}
    Hit operator*() const noexcept { return (*hits_)[n_]; }
    Iterator& operator++() noexcept { return ++n_, *this; }
    bool operator==(const Iterator& other) const noexcept { return n_ == other.n_; }

   private:
    const Hits* hits_;
    std::size_t n_;
  };

  std::size_t size() const noexcept { return points_.size(); }
  bool empty() const noexcept { return points_.empty(); }
  Hit operator[](std::size_t n) const noexcept { return source_.hit(points_[n]); }
  Iterator begin() const noexcept { return {*this, 0}; }
  Iterator end() const noexcept { return {*this, size()}; }

  std::uint32_t point(std::size_t n) const noexcept { return points_[n]; }
  /// Where `point` stands in the list, or size(). Looks from `from` on, near it first: for points
  /// that are asked for in order.
  std::size_t find(std::uint32_t point, std::size_t from = 0) const noexcept;
  /// Where the first point that is not below `point` stands, likewise.
  std::size_t not_below(std::uint32_t point, std::size_t from) const noexcept;
  /// Sum of weight * normal and of weight, as `set_sums` says.
  const Vec3& normal_sum() const noexcept { return normal_sum_; }
  double weight_sum() const noexcept { return weight_sum_; }

  /// For kernels: the numbers, and where to work hits out from.
  const std::uint32_t* points() const noexcept { return points_.data(); }
  const HitSource& source() const noexcept { return source_; }

  /// A kernel may write so many numbers more than it has found.
  static constexpr std::size_t kSpareRoom = 8;
  /// For the query: room for `count` numbers and kSpareRoom more, none written yet.
  std::uint32_t* room(std::size_t count);
  /// Keeps the first `found` numbers of those that were written into `room`, hits of `source`.
  /// Real-time safe.
  void keep(std::size_t found, const HitSource& source);
  /// What `normal_sum` and `weight_sum` give from now on. Real-time safe.
  void set_sums(const Vec3& normals, double weights) noexcept {
    normal_sum_ = normals, weight_sum_ = weights;
  }

  /// Adds the numbers of `other`, of the same pose, shell and grid, none of which is here. The sums
  /// stay. Real-time safe where there is room for all.
  void merge(const Hits& other) noexcept;

  /// Room for `count` hits. Allocates.
  void reserve(std::size_t count) { points_.reserve(count + kSpareRoom); }
  /// No hits; the memory stays. Real-time safe.
  void clear() noexcept;

 private:
  std::vector<std::uint32_t, Unwritten<std::uint32_t>> points_;
  HitSource source_;
  Vec3 normal_sum_ = Vec3::Zero();
  double weight_sum_ = 0.0;
};

/// The hits of one frame, in the shell's order. Reserved once for the whole shell: filling it never
/// allocates. A list that a query has filled is good while that query is.
struct HitList {
  Hits surface;   ///< points in surface voxels: the set S
  Hits interior;  ///< points in interior voxels: gone through
  Pose pose_WT;   ///< the pose looked up, its quaternion brought to unit norm
  PoseStatus pose_status = PoseStatus::kUsable;
  std::uint32_t tested = 0;  ///< points that culling left to test

  void reserve(std::size_t points) { surface.reserve(points), interior.reserve(points); }
  void clear() noexcept {
    surface.clear(), interior.clear(), pose_WT = {}, pose_status = PoseStatus::kUsable, tested = 0;
  }
};

}  // namespace voxtouch::contact

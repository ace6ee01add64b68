#pragma once
/// The colliding points of one frame, the input of every contact model.
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::contact {

/// Whether the pose is usable. Any other status has no hits and no force.
enum class PoseStatus : std::uint8_t {
  kUsable = 0,
  kNotAPose = 1,    ///< NaN, Inf, or a quaternion norm outside [1e-3, 1e3]
  kOutOfRange = 2,  ///< voxel indices exceed int32 at this distance from the grid
};

/// Merges the ascending list `from` into the ascending list `into`. Real-time safe if the capacity
/// suffices.
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

/// A vector that leaves new elements uninitialised, so that unused memory is never touched.
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

/// Sum of the three products of a rotation row with a vector, in the order of Eigen's matrix-vector
/// product: the first two rows from the left, the last from the right. Kernels use it, so that all
/// models get bit-identical values.
inline double row_sum(std::size_t row, double x, double y, double z) noexcept {
  return row < 2 ? x + y + z : x + (y + z);
}

/// Pose and points in single precision, as the query uses them (query_kernel.hpp): sufficient to
/// find hits that certainly have no force.
struct RoughSource {
  float a[3][3] = {};                     ///< as QueryFrame's
  float shift[3] = {};                    ///< as QueryFrame's
  float certain = -1.0F;                  ///< as QueryFrame's; negative: nothing is certain
  const float* place[3] = {};             ///< of the shell's points, frame T [m]
  const std::uint32_t* normal = nullptr;  ///< packed_normals.hpp; null: they cannot be packed
};

/// Pose and shell of the tool, from which a hit is computed by its point number. The shell must
/// outlive it.
struct HitSource {
  double r[3][3] = {};           ///< rotation of T in W
  double t[3] = {};              ///< tool's origin relative to the grid's [m]
  double edge = 1.0;             ///< voxel edge e [m]
  const double* place[3] = {};   ///< of the shell's points, frame T [m]
  const double* normal[3] = {};  ///< of the shell's points, frame T
  const double* area = nullptr;  ///< of the shell's points; null: unit weights
  RoughSource rough;

  /// Computes the hit of a point in double precision and fixed order, so that it is always
  /// bit-identical.
  Hit hit(std::uint32_t point) const noexcept;
};

/// Hits in ascending order of their points: `for (const Hit& hit : hits)`. Only point numbers are
/// stored; a hit is computed on access, which is cheaper than storing and loading it.
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
  /// Index of `point` in the list, or size(). The search starts at `from` and is fast nearby, for
  /// ascending queries.
  std::size_t find(std::uint32_t point, std::size_t from = 0) const noexcept;
  /// Index of the first point that is not below `point`, searched in the same way.
  std::size_t not_below(std::uint32_t point, std::size_t from) const noexcept;
  /// Sum of weight * normal and of weight, as set by `set_sums`.
  const Vec3& normal_sum() const noexcept { return normal_sum_; }
  double weight_sum() const noexcept { return weight_sum_; }

  /// For kernels: the point numbers, and the source to compute hits from.
  const std::uint32_t* points() const noexcept { return points_.data(); }
  const HitSource& source() const noexcept { return source_; }

  /// A kernel may write up to this many numbers beyond those found.
  static constexpr std::size_t kSpareRoom = 8;
  /// For the query: uninitialised room for `count` numbers and kSpareRoom more.
  std::uint32_t* room(std::size_t count);
  /// Keeps the first `found` numbers written into `room`, as hits of `source`. Real-time safe.
  void keep(std::size_t found, const HitSource& source);
  /// Sets the results of `normal_sum` and `weight_sum`. Real-time safe.
  void set_sums(const Vec3& normals, double weights) noexcept {
    normal_sum_ = normals, weight_sum_ = weights;
  }

  /// Merges the numbers of `other`, of the same pose, shell and grid, and disjoint from these. The
  /// sums do not change. Real-time safe if the capacity suffices.
  void merge(const Hits& other) noexcept;

  /// Reserves room for `count` hits. Allocates.
  void reserve(std::size_t count) { points_.reserve(count + kSpareRoom); }
  /// Removes all hits and keeps the memory. Real-time safe.
  void clear() noexcept;

 private:
  std::vector<std::uint32_t, Unwritten<std::uint32_t>> points_;
  HitSource source_;
  Vec3 normal_sum_ = Vec3::Zero();
  double weight_sum_ = 0.0;
};

/// The hits of one frame, in the order of the shell. Reserved once for the whole shell, so filling
/// it never allocates. A filled list is valid during the lifetime of its query.
struct HitList {
  Hits surface;   ///< points in surface voxels: the set S
  Hits interior;  ///< points in interior voxels
  Pose pose_WT;   ///< the queried pose with normalised quaternion
  PoseStatus pose_status = PoseStatus::kUsable;
  std::uint32_t tested = 0;  ///< points left by the culling

  void reserve(std::size_t points) { surface.reserve(points), interior.reserve(points); }
  void clear() noexcept {
    surface.clear(), interior.clear(), pose_WT = {}, pose_status = PoseStatus::kUsable, tested = 0;
  }
};

}  // namespace voxtouch::contact

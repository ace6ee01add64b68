#pragma once
/// The voxels that a triangle meets: separating-axis test of triangle and closed cube (13 axes),
/// exact in grid coordinates.
///
/// Each axis is a linear form in the voxel's index. The voxels of one row that pass all of them
/// form an interval, which is solved for and not searched. Rounding only makes the ends of a row
/// uncertain, and `exact_sign` decides uncertain ends. Zero-area triangles are segments or points
/// and pass the same tests.
#include <array>
#include <cstdint>

#include "core/types/geometry.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

/// Kind of intersection of a triangle and a voxel: none, only the border of the closed cube, or the
/// open cube.
enum class Meeting : std::uint8_t { kNone, kTouch, kOpen };

class TriangleVoxels {
 public:
  /// Corners in grid coordinates, within +-2^30.
  TriangleVoxels(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

  /// Box of the closed voxels that the triangle's bounding box meets, inclusive.
  const std::array<std::int32_t, 3>& first() const noexcept { return first_; }
  const std::array<std::int32_t, 3>& last() const noexcept { return last_; }

  /// Exact, for any voxel.
  Meeting meeting(const VoxelIndex& v) const noexcept;

  /// Axis of the runs of `for_each_run`: 1 (j) or 2 (k).
  int run_axis() const noexcept { return run_; }
  /// Calls f(i, row, run_first, run_last) for every row of met voxels with i in [i_first, i_last];
  /// `row` is the index along the axis 3 - run_axis().
  template <class F>
  void for_each_run(std::int32_t i_first, std::int32_t i_last, F&& f) const;

 private:
  /// value(v) = slope . (v - first) + constant >= 0 if the voxel passes; accurate to +- error.
  struct Form {
    std::array<double, 3> slope{};
    double constant = 0.0, error = 0.0;
    int kind = 0;  ///< edge forms: 4 * dropped axis + edge, plane: 16; negative: the other side
  };
  struct Range {
    std::int32_t first, last;
  };

  void add_edge_forms(int dropped) noexcept;
  void add_plane_forms() noexcept;
  void add(int kind, double side, const std::array<double, 3>& gradient, double at_zero,
           double magnitude) noexcept;
  double exact_value(const Form& form, const VoxelIndex& v) const noexcept;
  /// Rows (along the axis 3 - run_) within slab i, perhaps one too many.
  Range rows_in_slab(std::int32_t i) const noexcept;
  /// The run of one row; returns false if it is empty.
  bool solve_row(std::int32_t i, std::int32_t row, Range& run) const noexcept;
  VoxelIndex voxel(std::int32_t i, std::int32_t row, std::int32_t run) const noexcept {
    return run_ == 2 ? VoxelIndex{i, row, run} : VoxelIndex{i, run, row};
  }

  std::array<Vec3, 3> corner_;
  Vec3 normal_;  ///< twice the area vector, zero only for zero area
  std::array<std::int32_t, 3> first_{}, last_{};
  int run_ = 2;
  /// The box has one voxel across two axes and no corner on a border: all of it is met.
  bool boxed_ = false;
  int forms_ = 0;
  /// Nine edges projected along three axes, and both sides of the plane.
  std::array<Form, 11> form_;
};

template <class F>
void TriangleVoxels::for_each_run(std::int32_t i_first, std::int32_t i_last, F&& f) const {
  const auto row_axis = static_cast<std::size_t>(3 - run_),
             run_axis = static_cast<std::size_t>(run_);
  const std::int32_t from = i_first > first_[0] ? i_first : first_[0];
  const std::int32_t to = i_last < last_[0] ? i_last : last_[0];
  for (std::int32_t i = from; i <= to; ++i) {
    if (boxed_) {
      for (std::int32_t row = first_[row_axis]; row <= last_[row_axis]; ++row)
        f(i, row, first_[run_axis], last_[run_axis]);
      continue;
    }
    const Range rows = rows_in_slab(i);
    for (std::int32_t row = rows.first; row <= rows.last; ++row)
      if (Range run{}; solve_row(i, row, run))
        f(i, row, run.first, run.last);
  }
}

}  // namespace voxtouch::voxmap

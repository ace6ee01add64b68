#pragma once
/// Where short labels go beside the points of a chart, so that they cover neither each other nor the points.
#include <vector>

namespace voxtouch::cli {

/// Axis-parallel rectangle [px], y downwards.
struct Box {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  double width() const noexcept { return right - left; }
  double height() const noexcept { return bottom - top; }
};

/// Area that two boxes share; 0 where they only touch.
double overlap(const Box& a, const Box& b) noexcept;

/// Greedy: each label takes the first free place round its point, nearer ones and those to the right first; where none is free, the one that
/// covers least. Labels therefore depend on the order in which they are placed, and on nothing else.
class LabelLayout {
 public:
  explicit LabelLayout(const Box& plane) : plane_(plane) {}
  void block(const Box& box) { taken_.push_back(box); }
  /// A place for a label of this size beside the mark at (x, y) of radius `reach`; it is blocked from then on.
  Box place(double x, double y, double width, double height, double reach);

 private:
  double cost(const Box& box) const noexcept;

  Box plane_;
  std::vector<Box> taken_;
};

}  // namespace voxtouch::cli

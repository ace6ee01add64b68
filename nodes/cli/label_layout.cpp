#include "nodes/cli/label_layout.hpp"

#include <algorithm>

namespace voxtouch::cli {

double overlap(const Box& a, const Box& b) noexcept {
  const double wide = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double high = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return wide > 0.0 && high > 0.0 ? wide * high : 0.0;
}

double LabelLayout::cost(const Box& box) const noexcept {
  double covered = box.width() * box.height() - overlap(box, plane_);  // what sticks out of the plane
  for (const Box& other : taken_) covered += overlap(box, other);
  return covered;
}

Box LabelLayout::place(double x, double y, double width, double height, double reach) {
  constexpr struct { double x, y; } kSides[] = {{1, 0}, {1, -1}, {1, 1}, {-1, 0}, {-1, -1}, {-1, 1}, {0, -1}, {0, 1}};
  Box best;
  double least = -1.0;
  for (const double ring : {1.0, 1.8, 2.8}) {
    for (const auto& side : kSides) {
      // A corner is as near as an edge, so its label may come closer along both axes.
      const double gap = reach * ring * (side.x != 0 && side.y != 0 ? 0.6 : 1.0);
      const double cx = x + side.x * (gap + width / 2), cy = y + side.y * (gap + height / 2);
      const Box box{cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2};
      const double covered = cost(box);
      if (least < 0.0 || covered < least - 1e-9) best = box, least = covered;
      if (least <= 1e-9) {
        taken_.push_back(best);
        return best;
      }
    }
  }
  taken_.push_back(best);
  return best;
}

}  // namespace voxtouch::cli

#pragma once
/// Reads 12 bytes per point only: the lower bound of any query that visits every point.
#include <vector>

namespace voxtouch::bench {

struct ReadFloor {
  explicit ReadFloor(std::size_t points) : x(points, 1.0F), y(points, 2.0F), z(points, 3.0F) {}
  std::vector<float> x, y, z;

  float read() const { return add_up(x) + add_up(y) + add_up(z); }

 private:
  /// Four independent vectors of sums, so the memory limits the speed.
  using Floats = float __attribute__((vector_size(16)));
  static Floats load(const float* from) {
    Floats out;
    __builtin_memcpy(&out, from, sizeof out);
    return out;
  }
  static float add_up(const std::vector<float>& values) {
    Floats a = {}, b = {}, c = {}, d = {};
    const float* from = values.data();
    for (std::size_t n = 0; n + 16 <= values.size(); n += 16, from += 16)
      a += load(from), b += load(from + 4), c += load(from + 8), d += load(from + 12);
    const Floats all = (a + b) + (c + d);
    return (all[0] + all[1]) + (all[2] + all[3]);
  }
};

}  // namespace voxtouch::bench

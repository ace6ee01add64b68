#pragma once
/// Small scenes of boxes, written to a temporary folder.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/types/geometry.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::faults {

struct Box {
  Vec3 low, high;
};

/// Boxes as one OBJ file, each with separate corners.
inline std::string boxes_obj(const std::vector<Box>& boxes) {
  std::string text;
  int first = 1;
  for (const Box& b : boxes) {
    for (int n = 0; n < 8; ++n)
      text += fmt::format("v {} {} {}\n", n & 1 ? b.high.x() : b.low.x(),
                          n & 2 ? b.high.y() : b.low.y(), n & 4 ? b.high.z() : b.low.z());
    constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : kFaces) {
      text += fmt::format("f {} {} {}\n", first + f[0], first + f[1], first + f[2]);
      text += fmt::format("f {} {} {}\n", first + f[0], first + f[2], first + f[3]);
    }
    first += 8;
  }
  return text;
}

/// A folder with files that name each other.
class Inputs {
 public:
  void mesh(const std::string& name, const std::vector<Box>& boxes) {
    std::ofstream(folder_ / (name + ".obj")) << boxes_obj(boxes);
  }
  /// `body`: all but name and voxel size. The scene's file.
  std::filesystem::path scene(const std::string& name, const std::string& body) {
    const std::filesystem::path file = folder_ / (name + ".yaml");
    std::ofstream(file) << "scene: " << name << "\nvoxel_size: 0.002\n" << body;
    return file;
  }

 private:
  test::TemporaryFolder folder_;
};

/// The shipped ball, of 10 mm.
inline std::string ball() {
  return fmt::format("dynamic: {{mesh: {}/meshes/sphere.obj, scale: 0.01}}\n", VOXTOUCH_DEPLOY);
}

}  // namespace voxtouch::faults

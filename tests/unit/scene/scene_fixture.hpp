#pragma once
/// A temporary folder with two mesh files, for tests that read scenes.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/scene/scene_file.hpp"

namespace voxtouch::scene {

class SceneFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "voxtouch_scene_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("b.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  Scene parse(const std::string& text) const { return parse_scene(text, folder_ / "s.yaml"); }

  std::filesystem::path folder_;
};

/// The smallest valid scene.
inline const std::string kSmall =
    "scene: small\n"
    "voxel_size: 0.002\n"
    "static: [{mesh: a.obj}]\n"
    "dynamic: {mesh: b.obj}\n"
    "contact: {stiffness_n_per_m: 10}\n";

/// All keys of a scene, each with a value other than its default.
inline const std::string kFull = R"(# a scene with all keys
scene: full
voxel_size: 2.0e-3
static:
  - {mesh: a.obj, scale: 0.5, position: [1, 2, 3], orientation: [0.7071068, 0.7071068, 0, 0], origin: [-0.1, -0.2, +0.3],
     parts: [{sphere: {centre: [0.1, 0.2, 0.3], radius: 0.04}},
             {box: {size: [1, 2, 3], position: [4, 5, 6], orientation: [0, 1, 0, 0]}},
             {cylinder: {radius: 0.5, length: 2, position: [7, 8, 9], orientation: [0, 0, 0, -1]}}]}
  - mesh: b.obj
dynamic: {mesh: b.obj, scale: 0.01, shell: naive, position: [0.01, 0, 0], orientation: [0, 0, 1, 0], parts: [{sphere: {radius: 1}}]}
contact: {model: original, stiffness_n_per_m: 12.5}
effects: []
coupling: {kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 0.5}
device: {position_scale: 2, force_scale: 0.25, pose: {position: [0, 0, 1], orientation: [0.5, 0.5, 0.5, 0.5]},
         tool: {position: [0.1, 0, 0], orientation: [0, 0, 1, 0]}, clutch_button: 1}
motions:
  slide: {path: [[0, 0, 0.1], [0.1, 0, 0], [0.2, 0, 0]], speed_m_per_s: 0.1, hold_s: 0.25, repeat_from: 1, orientation: [0, 1, 0, 0]}
  round-1: {path: [[0.1, 0, 0]], circle: {centre: [0, 0, 0], axis: [0, 0, 2]}, speed_m_per_s: 0.07}
)";

}  // namespace voxtouch::scene

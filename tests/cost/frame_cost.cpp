// Renders frames of a scene in one of several ways, for callgrind to count and for the heap to be
// weighed. Only `counted_frame` is counted, not building.
//
//   frame_cost SCENE MOTION FRAMES MODE
//
// Modes:
//   scene    as in the ring: contact, and the effects of the scene
//   contact  contact alone, built by hand without build_scene
//   touch    contact alone of build_scene, for any model and meshes
//   effects  the effects alone; their contact is rendered uncounted
//
// Prints `{"live": bytes, "peak": bytes, "plan": bytes, "sum": force}`: heap in use after the
// build, and its maximum during it.
#include <array>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <random>
#include <string>

#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include "core/mesh/import.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/contact_parameters.hpp"
#include "core/scene/scene_file.hpp"
#include "core/voxmap/object_grid.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/support/exact_shell.hpp"

namespace {
std::size_t live_bytes = 0, peak_bytes = 0;
constexpr std::size_t kHeader = 16;  ///< keeps the alignment that malloc gives
}  // namespace

// The requested size is stored before each block, because malloc's rounding depends on earlier
// blocks. Not inlined: otherwise the compiler warns about malloc with delete.
__attribute__((noinline)) void* operator new(std::size_t size) {
  auto* p = static_cast<unsigned char*>(std::malloc(size + kHeader));
  if (p == nullptr)
    throw std::bad_alloc();
  std::memcpy(p, &size, sizeof size);
  live_bytes += size;
  if (live_bytes > peak_bytes)
    peak_bytes = live_bytes;
  return p + kHeader;
}
__attribute__((noinline)) void operator delete(void* p) noexcept {
  if (p == nullptr)
    return;
  std::size_t size = 0;
  unsigned char* const block = static_cast<unsigned char*>(p) - kHeader;
  std::memcpy(&size, block, sizeof size);
  live_bytes -= size;
  std::free(block);
}
__attribute__((noinline)) void operator delete(void* p, std::size_t) noexcept {
  operator delete(p);
}

extern "C" __attribute__((noinline)) void counted_frame(const std::function<void()>& frame) {
  frame();
}

namespace voxtouch::test {
namespace {

/// A scene for contact only.
struct HandBuilt {
  explicit HandBuilt(const scene::Scene& scene) {
    const auto mesh = [&](const scene::MeshSpec& spec) {
      mesh::ImportOptions options;
      options.scale = spec.scale, options.pose = spec.pose,
      options.voxel_size_m = scene.voxel_size_m;
      return mesh::import_mesh(spec.path, options).mesh;
    };
    const mesh::TriangleMesh fixed = mesh(scene.static_meshes.at(0)),
                             moving = mesh(scene.dynamic_mesh);
    voxmap = std::make_unique<voxmap::Voxmap>(
        voxmap::voxelise(fixed, voxmap::object_grid(fixed, scene.voxel_size_m), serial_for()));
    pointshell::Pointshell shell = test::exact_shell(moving, scene.voxel_size_m);
    const contact::ContactParameters parameters = rendering::contact_parameters(
        scene.contact, contact::ContactModelKind::kAdapted, shell, {});
    renderer = std::make_unique<contact::ContactRenderer>(
        *voxmap, std::move(shell), contact::ContactModelKind::kAdapted, parameters);
  }
  std::unique_ptr<voxmap::Voxmap> voxmap;
  std::unique_ptr<contact::ContactRenderer> renderer;
};

constexpr double kBeginS = 0.7;  ///< the slides of deploy/scenes touch from about here

/// The hand along the motion at 1 kHz, trembling by a fixed seed.
class Hand {
 public:
  explicit Hand(const Motion& motion) : motion_(motion), random_(1) {}
  rendering::ToolState at(int n) {
    rendering::ToolState tool;
    const MotionPoint point = motion_at(motion_, kBeginS + 1e-3 * n);
    const auto draw = [this] {
      return 1e-5 * (static_cast<double>(random_() % 2001) / 1000.0 - 1.0);
    };
    const double x = draw(), y = draw(), z = draw();
    tool.pose = {point.position + Vec3(x, y, z), motion_.orientation};
    tool.twist.linear = point.velocity;
    return tool;
  }

 private:
  const Motion& motion_;
  std::mt19937 random_;
};

/// The ring's result of a frame, for contact without effects.
__attribute__((noinline)) rendering::SceneFrame contact_frame(
    contact::ContactRenderer& contact, const rendering::ToolState& tool) noexcept {
  rendering::SceneFrame frame;
  frame.object = tool.pose;
  frame.touch = contact.render(tool.pose);
  const contact::ContactResult& result = frame.touch.contact;
  frame.wrench = result.wrench;
  frame.stiffness = result.stiffness;
  frame.stiffness_bound_n_per_m = result.stiffness_bound_n_per_m;
  return frame;
}

int run(const std::string& file, const std::string& motion, int frames, const std::string& mode) {
  const scene::Scene scene = scene::load_scene(file);
  Hand hand(scene.motions.at(motion));
  const std::size_t before = live_bytes;
  peak_bytes = live_bytes;
  std::unique_ptr<HandBuilt> by_hand;
  std::unique_ptr<rendering::BuiltScene> built;
  if (mode == "contact")
    by_hand = std::make_unique<HandBuilt>(scene);
  else
    built = rendering::build_scene(scene, serial_for());
  const std::size_t live = live_bytes - before, peak = peak_bytes - before;
  CALLGRIND_START_INSTRUMENTATION;  // not needed before, where it would take most of the time
  double sum = 0.0;
  for (int n = 0; n < frames; ++n) {
    const rendering::ToolState tool = hand.at(n);
    const double time_s = 1e-3 * n;
    rendering::SceneFrame frame;
    if (mode == "scene") {
      counted_frame([&] { frame = built->scene_renderer().render(tool, time_s); });
    } else if (mode != "effects") {
      contact::ContactRenderer& contact = by_hand ? *by_hand->renderer : built->renderer();
      counted_frame([&] { frame = contact_frame(contact, tool); });
    } else {
      const contact::StageResult touch = built->contacts().render(tool.pose, time_s);
      const std::span<const effects::ObjectContact> contacts = built->contacts().parts(touch);
      rendering::SceneRenderer& renderer = built->scene_renderer();
      counted_frame([&] {
        frame.effects = renderer.effects().apply(
            renderer.effect_frame(tool, rendering::SceneRenderer::kDefaultStepS, time_s, contacts));
      });
    }
    sum += frame.wrench.force.norm() + frame.effects.wrench.force.norm();
  }
  fmt::print("{{\"live\": {}, \"peak\": {}, \"plan\": {}, \"sum\": {}}}\n", live, peak,
             built ? built->plan().bytes : 0, sum);
  return 0;
}

}  // namespace
}  // namespace voxtouch::test

int main(int argc, char** argv) {
  if (argc != 5)
    return 2;
  return voxtouch::test::run(argv[1], argv[2], std::atoi(argv[3]), argv[4]);
}

#include "nodes/scene_build/build_here.hpp"

#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/scene_build/build_progress.hpp"

namespace voxtouch::scene_build {

std::unique_ptr<rendering::BuiltScene> build_here(const scene::Scene& scene, const BuildHow& how) {
  std::optional<BuildProgress> progress;
  ParallelFor loop = how.loop;
  if (how.reports_progress)
    loop = progress.emplace(how.who).counted(loop);
  const ParallelFor while_requested = [&](std::size_t count,
                                          const std::function<void(std::size_t)>& body) {
    loop(count, [&](std::size_t i) {
      if (how.go_on)
        how.go_on();
      body(i);
    });
  };
  return rendering::build_scene(scene, while_requested,
                                {.model = how.model, .read = mesh_import::mesh_process()},
                                [&](const std::string& step) {
                                  if (how.go_on)
                                    how.go_on();
                                  if (progress)
                                    progress->begin_step(step);
                                });
}

}  // namespace voxtouch::scene_build

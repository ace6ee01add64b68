#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <optional>

#include "core/reference/reference_scene.hpp"
#include "core/reference/reference_wrench.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/cli/probe/pose_csv.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

struct ProbeOptions {
  std::filesystem::path scene, poses;
  std::string model;
  bool points = false;
  scene_build::CacheOptions cache;
};

/// Ids as `3 5-8 11`.
std::string ranges(const std::vector<std::uint32_t>& ids) {
  std::string text;
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1)
      ++last;
    text += fmt::format("{}{}", text.empty() ? "" : " ", ids[i]);
    if (last > i)
      text += fmt::format("-{}", ids[last]);
    i = last + 1;
  }
  return text;
}

/// What a static object without an inside leaves open.
const Vec3 kUnknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

int probe_reference(const scene::Scene& scene, const std::vector<Pose>& poses) {
  const reference::ReferenceScene reference(scene);
  std::optional<reference::ReferenceWrench> truth;
  if (reference.inside_known())
    truth.emplace(scene, 0.25 * scene.voxel_size_m);
  log::print_result("gap_m,dx,dy,dz,unique_face,self_check,fx,fy,fz,tx,ty,tz\n");
  for (const Pose& pose : poses) {
    const reference::GapResult g = reference.gap(pose);
    const Wrench w = truth ? truth->at(pose).wrench : Wrench{kUnknown, kUnknown};
    log::print_result("{},{},{},{},{},{},{},{},{},{},{},{}\n", g.gap_m, g.direction.x(),
                      g.direction.y(), g.direction.z(), int{g.unique_face}, int{g.self_check},
                      w.force.x(), w.force.y(), w.force.z(), w.torque.x(), w.torque.y(),
                      w.torque.z());
  }
  return 0;
}

int probe(const ProbeOptions& o) {
  const scene::Scene scene = scene::load_scene(o.scene);
  const std::vector<Pose> poses = read_poses(o.poses);
  if (o.model == "reference")
    return mesh_import::rehearse_reading(scene), probe_reference(scene, poses);
  std::optional<contact::ContactModelKind> model;  // absent: the scene's own
  if (!o.model.empty())
    contact::parse_contact_model(o.model, model.emplace());
  const auto built =
      scene_build::build_here(scene, {.who = "probe", .cache = o.cache, .model = model});
  for (const std::string& warning : built->plan().warnings)
    log::tell("warning: {}\n", warning);
  log::print_result("nS,nI,coh,fx,fy,fz,tx,ty,tz{}\n", o.points ? ",S" : "");
  std::vector<std::uint32_t> ids;
  for (const Pose& pose : poses) {
    const contact::ContactResult r = built->contacts().probe(pose, ids);
    const Vec3 &f = r.wrench.force, &t = r.wrench.torque;
    log::print_result("{},{},{},{},{},{},{},{},{}", r.surface_hits, r.interior_hits, r.coherence,
                      f.x(), f.y(), f.z(), t.x(), t.y(), t.z());
    log::print_result("{}\n", o.points ? "," + ranges(ids) : "");
  }
  return 0;
}

}  // namespace

void add_probe(CLI::App& app, Action& action) {
  auto o = std::make_shared<ProbeOptions>();
  CLI::App* verb = app.add_subcommand("probe",
                                      "Wrenches for a list of poses, one CSV row each: "
                                      "nS,nI,coh,fx,fy,fz,tx,ty,tz (world axes, torque about the "
                                      "tool's\n"
                                      "origin). Memoryless: neither blend nor hold. --model "
                                      "reference prints gap and push direction\n"
                                      "instead, and the true wrench for a stiffness of 1 N/m^3");
  verb->add_option("SCENE", o->scene,
                   "Scene file (YAML), or the name of one that comes with voxtouch")
      ->required()
      ->transform(runtime::scene_argument());
  verb->add_option("--poses", o->poses,
                   "CSV with the columns qw,qx,qy,qz,tx,ty,tz: tool in world; - for standard input")
      ->required();
  verb->add_option("--model", o->model,
                   "original, adapted, field or reference; default: the scene's")
      ->check(CLI::IsMember({"original", "adapted", "field", "reference"}));
  scene_build::add_cache_options(*verb, o->cache);
  verb->add_flag("--points", o->points, "Adds a column with the ids of the colliding points");
  verb->callback([o, &action] { action = [o] { return probe(*o); }; });
}

}  // namespace voxtouch::cli

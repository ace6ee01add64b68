#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <optional>

#include "core/reference/reference_scene.hpp"
#include "core/reference/reference_wrench.hpp"
#include "core/rendering/scene_renderer.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/cli/machine.hpp"
#include "nodes/cli/probe/pose_csv.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

struct ProbeOptions {
  std::filesystem::path scene, poses;
  std::string model;
  double spring_n_per_m = 0.0;  ///< of a virtual tool; 0: poses without memory
  bool points = false, time = false;
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

/// Values that an object without an inside leaves undefined.
const Vec3 kUnknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

int probe_reference(const scene::Scene& scene, const std::vector<Pose>& poses) {
  const reference::ReferenceScene reference(scene);
  std::optional<reference::ReferenceWrench> truth;
  if (reference.inside_known())
    truth.emplace(scene, 0.25 * scene.voxel_size_m);
  console::print_result("gap_m,dx,dy,dz,unique_face,self_check,fx,fy,fz,tx,ty,tz\n");
  for (const Pose& pose : poses) {
    const reference::GapResult g = reference.gap(pose);
    const Wrench w = truth ? truth->at(pose).wrench : Wrench{kUnknown, kUnknown};
    console::print_result("{},{},{},{},{},{},{},{},{},{},{},{}\n", g.gap_m, g.direction.x(),
                          g.direction.y(), g.direction.z(), int{g.unique_face}, int{g.self_check},
                          w.force.x(), w.force.y(), w.force.z(), w.torque.x(), w.torque.y(),
                          w.torque.z());
  }
  return 0;
}

std::string time_column(bool time, double begin_s) {
  return time ? fmt::format(",{:.2f}", 1e6 * (thread_cpu_s() - begin_s)) : "";
}

/// The poses are the path of a hand, one a millisecond. Prints the wrench of the spring between
/// hand and virtual tool.
int probe_path(const scene::Scene& scene, const std::vector<Pose>& poses, const ProbeOptions& o) {
  constexpr double kPeriodS = 0.001;
  if (!scene.virtual_tool())
    throw std::runtime_error(
        fmt::format("{}: --spring needs `contact: {{rendering: virtual_tool}}`", o.scene.string()));
  const auto built = scene_build::build_here(scene, {.who = "probe"});
  rendering::SceneRenderer& renderer = built->scene_renderer();
  renderer.reset();
  renderer.set_spring_target(o.spring_n_per_m);
  console::print_result("in_contact,fx,fy,fz,tx,ty,tz{}\n", o.time ? ",us" : "");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    rendering::ToolState hand{.pose = poses[i], .twist = {}};
    if (i > 0)
      hand.twist.linear = (poses[i].position - poses[i - 1].position) / kPeriodS;
    const double begin_s = thread_cpu_s();
    const rendering::SceneFrame frame = renderer.render(hand, kPeriodS * static_cast<double>(i));
    const std::string time = time_column(o.time, begin_s);
    const Vec3 &f = frame.wrench.force, &t = frame.wrench.torque;
    console::print_result("{},{},{},{},{},{},{}{}\n", int{frame.tool.constrained}, f.x(), f.y(),
                          f.z(), t.x(), t.y(), t.z(), time);
  }
  return 0;
}

int probe(const ProbeOptions& o) {
  const scene::Scene scene = scene::load_scene(o.scene);
  const std::vector<Pose> poses = read_poses(o.poses);
  if (o.spring_n_per_m > 0.0)
    return probe_path(scene, poses, o);
  if (o.model == "reference")
    return mesh_import::dry_run_reading(scene), probe_reference(scene, poses);
  std::optional<contact::ContactModelKind> model;  // absent: that of the scene
  if (!o.model.empty())
    contact::parse_contact_model(o.model, model.emplace());
  const auto built = scene_build::build_here(scene, {.who = "probe", .model = model});
  for (const std::string& warning : built->plan().warnings)
    console::log("warning: {}\n", warning);
  console::print_result("nS,nI,coh,fx,fy,fz,tx,ty,tz{}{}\n", o.points ? ",S" : "",
                        o.time ? ",us" : "");
  std::vector<std::uint32_t> ids;
  for (const Pose& pose : poses) {
    const double begin_s = thread_cpu_s();
    const contact::ContactResult r = built->contacts().probe(pose, ids);
    const std::string time = time_column(o.time, begin_s);
    const Vec3 &f = r.wrench.force, &t = r.wrench.torque;
    console::print_result("{},{},{},{},{},{},{},{},{}", r.surface_hits, r.interior_hits,
                          r.coherence, f.x(), f.y(), f.z(), t.x(), t.y(), t.z());
    console::print_result("{}{}\n", o.points ? "," + ranges(ids) : "", time);
  }
  return 0;
}

}  // namespace

void add_probe(CLI::App& app, Action& action) {
  auto o = std::make_shared<ProbeOptions>();
  CLI::App* verb = app.add_subcommand("probe");
  verb->add_option("SCENE", o->scene, "Scene file (YAML), or the name of a shipped scene")
      ->required()
      ->transform(runtime::scene_argument());
  verb->add_option("--poses", o->poses,
                   "CSV of tool poses in world, columns qw,qx,qy,qz,tx,ty,tz; - for standard input")
      ->required();
  verb->add_option("--model", o->model,
                   "original, adapted, field or reference; default: the scene's")
      ->check(CLI::IsMember({"original", "adapted", "field", "reference"}));
  verb->add_option("--spring", o->spring_n_per_m,
                   "Stiffness of a virtual tool's spring [N/m]; the poses are a path of the hand, "
                   "1 ms apart")
      ->check(runtime::require_positive);
  verb->add_flag("--time", o->time, "Adds a column with the CPU time of each pose [us]");
  verb->add_flag("--points", o->points, "Adds a column with the ids of the colliding points");
  verb->callback([o, &action] { action = [o] { return probe(*o); }; });
}

}  // namespace voxtouch::cli

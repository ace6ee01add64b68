#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/accuracy/accuracy.hpp"
#include "core/felt/felt.hpp"
#include "core/first_scene/measure_part.hpp"
#include "core/first_scene/scene_text.hpp"
#include "core/first_scene/try_scene.hpp"
#include "core/mesh/import.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/program_folder.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/machine.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/progress.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  fs::path part, tool, out;
  std::string device = "sim-phantom", part_unit, tool_unit;
  scene_build::CacheOptions cache;
};

struct ReadMesh {
  mesh::ImportedMesh mesh;  ///< in metres
  double scale = 1.0;
  std::string unit;  ///< a sentence
};

/// In the file's own numbers first, since they tell the unit.
ReadMesh read_mesh(const fs::path& file, const std::string& unit) {
  const mesh::TriangleReader reader = mesh_import::mesh_process();
  ReadMesh read{.mesh = mesh::import_mesh(file, {}, reader), .scale = 1.0, .unit = {}};
  const double extent = (read.mesh.report.max - read.mesh.report.min).maxCoeff();
  first_scene::Unit guess = first_scene::likely_unit(extent);
  if (unit == first_scene::kMillimetre.name)
    guess = first_scene::kMillimetre;
  if (unit == first_scene::kMetre.name)
    guess = first_scene::kMetre;
  read.scale = guess.metres;
  read.unit = fmt::format(
      "{} is {:.4g} {} at its largest{}.", file.filename().string(), extent, guess.name,
      unit.empty() ? ", if its numbers are in that unit: --unit and --tool-unit say otherwise"
                   : "");
  if (read.scale != 1.0)
    read.mesh = mesh::import_mesh(file, {.scale = read.scale}, reader);
  return read;
}

/// As a scene file in `folder` is to name it: what lies there or below by a short path, all else by
/// its whole one.
std::string named_from(const fs::path& folder, const fs::path& file) {
  const fs::path relative = fs::relative(file, folder);
  return (relative.empty() || *relative.begin() == ".." ? fs::canonical(file) : relative).string();
}

void write_new(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::out | std::ios::noreplace);
  out << text;
  out.close();
  if (!out)
    throw std::runtime_error(
        fmt::format("{} cannot be written: is it there already, is there room, and may you write "
                    "there? --out FILE is another",
                    file.string()));
}

struct Meshes {
  ReadMesh part;
  first_scene::Tool tool;
  first_scene::SceneNames names;
  std::vector<std::string> units;  ///< sentences
};

Meshes read_meshes(const NewOptions& o, const fs::path& out) {
  Meshes m{.part = read_mesh(o.part, o.part_unit), .tool = {}, .names = {}, .units = {}};
  m.units.push_back(m.part.unit);
  m.names = {.scene = first_scene::scene_name(o.part.stem().string()),
             .part_file = named_from(out.parent_path(), o.part),
             .tool_file = (fs::canonical(shared_folder() / "meshes") / "sphere.obj").string(),
             .part_scale = m.part.scale};
  if (o.tool.empty())
    return m;
  const ReadMesh tool = read_mesh(o.tool, o.tool_unit);
  m.units.push_back(tool.unit);
  m.tool = first_scene::tool_of(tool.mesh.mesh);
  m.names.tool_file = named_from(out.parent_path(), o.tool), m.names.tool_scale = tool.scale;
  return m;
}

first_scene::ProposedScene propose(Meshes& m, const first_scene::ModelChoice& contact) {
  first_scene::ProposedScene proposed =
      first_scene::propose_scene(m.part.mesh.mesh, m.part.mesh.report, m.tool, contact);
  if (m.tool.sphere)
    m.names.tool_scale = proposed.tool.reach_m;  // the shipped sphere has radius 1
  proposed.reasons.insert(proposed.reasons.begin(), m.units.begin(), m.units.end());
  return proposed;
}

/// The short form of `voxtouch accuracy`: few contacts, the scene's own voxels, no spread.
first_scene::ModelChoice measured_model(const scene::Scene& scene,
                                        const first_scene::ModelChoice& usual) {
  accuracy::AccuracyOptions options;
  options.contacts = first_scene::kMeasuredContacts;
  options.spread_contacts = options.phases = 0;
  options.cpu_time_s = thread_cpu_s;
  options.read = mesh_import::mesh_process();
  options.progress = [tell = log::tell_each_second("new")](const std::string& what, double share,
                                                           double left_s) {
    tell(fmt::format("measuring contact models, {:.0f} %, about {:.0f} s left: {}", 100.0 * share,
                     left_s, what));
  };
  return first_scene::measured_model(
      accuracy::measure_accuracy(scene, first_scene::models_to_measure(scene.voxel_size_m), options,
                                 serial_for()),
      usual);
}

/// What a person must know of the scene as it is: what is wrong with it, and how it feels.
std::vector<std::string> tried(const scene::Scene& scene,
                               const coupling::design::DeviceModel& device,
                               const scene_build::CacheOptions& cache) {
  std::vector<std::string> said;
  const auto built = scene_build::build_here(scene, {.who = "new", .cache = cache});
  if (const std::string wrong = first_scene::what_is_wrong(scene, *built); !wrong.empty())
    said.push_back("To be mended by hand: " + wrong + ".");
  const rendering::StiffnessBounds bounds{built->plan().contact_n_per_m,
                                          built->plan().contact_nm_per_rad};
  const fitting::FittedCoupling fitted =
      fitting::fit_coupling(scene, device, bounds.translation, bounds.rotation);
  if (!fitted.refusal.empty())
    said.push_back("To be mended by hand: " + fitted.refusal);
  if (const std::string felt = felt::felt_sentence(fitted, scene, device, *built); !felt.empty())
    said.push_back(felt);
  return said;
}

int make_new(const NewOptions& o) {
  const coupling::design::DeviceModel device = find_device(o.device);
  const fs::path out = fs::absolute(
      o.out.empty() ? fs::path(first_scene::scene_name(o.part.stem().string()) + ".yaml") : o.out);
  if (fs::exists(out))
    throw std::runtime_error(fmt::format(
        "{} is there already and is left as it is; --out FILE is another", out.string()));
  Meshes meshes = read_meshes(o, out);
  const mesh::MeshReport& report = meshes.part.mesh.report;
  for (const std::string& sentence : report.sentences())
    log::tell("warning: {}\n", sentence);

  const first_scene::ModelChoice usual = first_scene::usual_model(report);
  first_scene::ProposedScene proposed = propose(meshes, usual);
  write_new(out, first_scene::scene_text(proposed, meshes.names));
  try {
    if (first_scene::has_inside(report) && first_scene::is_soon_measured(report)) {
      proposed = propose(meshes, measured_model(scene::load_scene(out), usual));
      fs::remove(out);
      write_new(out, first_scene::scene_text(proposed, meshes.names));
    }
    for (std::string& sentence : tried(scene::load_scene(out), device, o.cache))
      proposed.reasons.push_back(std::move(sentence));
  } catch (const std::exception&) {
    fs::remove(out);  // a scene that cannot even be built is no begin
    throw;
  }
  for (const std::string& reason : proposed.reasons)
    log::print_result("{}\n", reason);
  log::print_result(
      "\n{} is written. Feel it, and see it:\n  voxtouch up {} --device {} --motion press --view\n",
      out.string(), o.out.empty() ? out.filename().string() : out.string(),
      device_argument(o.device));
  return 0;
}

}  // namespace

void add_new(CLI::App& app, Action& action) {
  auto o = std::make_shared<NewOptions>();
  CLI::App* verb = app.add_subcommand(
      "new",
      "Writes a scene file for a part of yours that runs as it is, and says what was guessed: "
      "unit, voxel size, tool, two motions of a\n"
      "simulated hand, and the contact model, by a short form of `voxtouch accuracy` where the "
      "part is closed and below 500,000 triangles. Each line of the file may be changed "
      "afterwards.\n"
      "Try: voxtouch new part.stl   and then   voxtouch up part.yaml --motion press --view");
  verb->add_option("PART", o->part, "Mesh to be felt: OBJ, STL, PLY, glTF/GLB, COLLADA")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("TOOL", o->tool, "Mesh that the hand holds, by its origin; default: a sphere")
      ->check(CLI::ExistingFile);
  verb->add_option("--device", o->device, "A device by name, or a file that describes one")
      ->capture_default_str();
  const CLI::IsMember units({first_scene::kMillimetre.name, first_scene::kMetre.name});
  verb->add_option("--unit", o->part_unit,
                   "Unit of the part's numbers; default: whichever makes it fit a desk")
      ->check(units);
  verb->add_option("--tool-unit", o->tool_unit, "Unit of the tool's numbers")->check(units);
  scene_build::add_cache_options(*verb, o->cache);
  verb->add_option("--out", o->out,
                   "Scene file to write; default: PART's name with .yaml, in the current folder");
  verb->callback([o, &action] { action = [o] { return make_new(*o); }; });
}

}  // namespace voxtouch::cli

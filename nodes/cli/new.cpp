#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/device_fit/force_preview.hpp"
#include "core/mesh/import.hpp"
#include "core/scene/scene_file.hpp"
#include "core/scene_proposal/measure_part.hpp"
#include "core/scene_proposal/scene_text.hpp"
#include "core/scene_proposal/try_scene.hpp"
#include "core/types/program_folder.hpp"
#include "nodes/cli/force_line.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/new.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/design_text/design_text.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  fs::path part, tool, out;
  std::string device = "sim-phantom", part_unit, tool_unit;
};

struct ReadMesh {
  mesh::ImportedMesh mesh;  ///< in metres
  double scale = 1.0;
  std::string unit;  ///< a sentence
};

/// Reads the mesh in the numbers of the file first: they suggest the unit if the format has none.
ReadMesh read_mesh(const fs::path& file, const std::string& unit) {
  const mesh::TriangleReader reader = mesh_import::mesh_process();
  ReadMesh read{.mesh = mesh::import_mesh(file, {}, reader), .scale = 1.0, .unit = {}};
  const double extent = (read.mesh.report.max - read.mesh.report.min).maxCoeff();
  const bool declared = mesh::has_own_unit(file);
  scene_proposal::Unit guess =
      declared ? scene_proposal::kMetre : scene_proposal::likely_unit(extent);
  if (unit == scene_proposal::kMillimetre.name)
    guess = scene_proposal::kMillimetre;
  if (unit == scene_proposal::kMetre.name)
    guess = scene_proposal::kMetre;
  read.scale = guess.metres;
  read.unit =
      fmt::format("{}: largest extent {:.4g} {}{}.", file.filename().string(), extent, guess.name,
                  !unit.empty() ? ""
                  : declared    ? ", in the file's own unit"
                                : ", unit guessed from the size (--unit and --tool-unit set it)");
  if (read.scale != 1.0)
    read.mesh = mesh::import_mesh(file, {.scale = read.scale}, reader);
  return read;
}

/// The path of `file` in a scene file in `folder`: relative, so that both can be moved together;
/// absolute if only the root folder is common.
std::string named_from(const fs::path& folder, const fs::path& file) {
  const fs::path whole = fs::canonical(file), from = fs::weakly_canonical(folder);
  const auto root = [](const fs::path& path) { return *std::next(path.begin()); };
  const bool under_one_folder = from != from.root_path() && root(whole) == root(from);
  return (under_one_folder ? whole.lexically_relative(from) : whole).string();
}

void write_new(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::out | std::ios::noreplace);
  out << text;
  out.close();
  if (!out)
    throw std::runtime_error(
        fmt::format("Cannot write {}. Check that it does not exist, the free space and the "
                    "permissions, or choose another file with --out",
                    file.string()));
}

/// The copy of the shipped sphere next to the scene `out`.
fs::path sphere_file(const fs::path& out) { return fs::path(out).replace_extension(".tool.obj"); }

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Copies the shipped sphere next to the scene `out`. Returns whether the file is new; an equal
/// file is used as it is.
bool copy_sphere(const fs::path& out) {
  const std::string sphere = contents(shared_folder() / "meshes" / "sphere.obj");
  if (fs::exists(sphere_file(out)) && contents(sphere_file(out)) == sphere)
    return false;
  write_new(sphere_file(out), sphere);
  return true;
}

struct Meshes {
  ReadMesh part;
  scene_proposal::Tool tool;
  scene_proposal::SceneNames names;
  std::vector<std::string> units;  ///< sentences
};

Meshes read_meshes(const NewOptions& o, const fs::path& out) {
  Meshes m{.part = read_mesh(o.part, o.part_unit), .tool = {}, .names = {}, .units = {}};
  m.units.push_back(m.part.unit);
  m.names = {.scene = scene_proposal::scene_name(o.part.stem().string()),
             .part_file = named_from(out.parent_path(), o.part),
             .tool_file = sphere_file(out).filename().string(),
             .part_scale = m.part.scale};
  if (o.tool.empty())
    return m;
  const ReadMesh tool = read_mesh(o.tool, o.tool_unit);
  m.units.push_back(tool.unit);
  m.tool = scene_proposal::tool_of(tool.mesh.mesh);
  m.names.tool_file = named_from(out.parent_path(), o.tool), m.names.tool_scale = tool.scale;
  return m;
}

scene_proposal::ProposedScene propose(Meshes& m) {
  scene_proposal::ProposedScene proposed =
      scene_proposal::propose_scene(m.part.mesh.mesh, m.part.mesh.report, m.tool);
  if (m.tool.sphere)
    m.names.tool_scale = proposed.tool.reach_m;  // the shipped sphere has radius 1
  proposed.reasons.insert(proposed.reasons.begin(), m.units.begin(), m.units.end());
  return proposed;
}

/// Faults of the scene and its force preview, as sentences.
std::vector<std::string> findings(const scene::Scene& scene,
                                  const coupling::design::DeviceModel& device) {
  std::vector<std::string> sentences;
  const auto built = scene_build::build_here(scene, {.who = "new"});
  if (const std::string wrong = scene_proposal::validate(scene, *built); !wrong.empty())
    sentences.push_back("Correct by hand: " + wrong + ".");
  const rendering::StiffnessBounds bounds{built->plan().contact_n_per_m,
                                          built->plan().contact_nm_per_rad};
  const device_fit::FittedCoupling fitted =
      device_fit::fit_coupling(scene, device, bounds.translation, bounds.rotation);
  if (!fitted.refusal.empty())
    sentences.push_back("Correct by hand: " + design_text::sentence_of(fitted.refusal));
  if (const auto preview =
          device_fit::force_preview(fitted, scene, device, bounds, built->plan().tool_reach_m))
    for (const std::string& line : force_lines(*preview, device.name))
      sentences.push_back(line);
  return sentences;
}

/// Writes the scene to `out`; returns its reasons, as sentences.
std::vector<std::string> write_scene(const NewOptions& o, const fs::path& out) {
  const coupling::design::DeviceModel device = find_device(o.device);
  if (fs::exists(out))
    throw std::runtime_error(fmt::format(
        "{} exists and is not overwritten. Choose another file with --out", out.string()));
  Meshes meshes = read_meshes(o, out);
  const mesh::MeshReport& report = meshes.part.mesh.report;
  for (const std::string& sentence : meshes.part.mesh.warnings)
    console::log("warning: {}\n", sentence);
  for (const std::string& sentence : report.sentences())
    console::log("warning: {}\n", sentence);

  scene_proposal::ProposedScene proposed = propose(meshes);
  write_new(out, scene_proposal::scene_text(proposed, meshes.names));
  bool copied = false;
  try {
    copied = meshes.tool.sphere && copy_sphere(out);
    for (std::string& sentence : findings(scene::load_scene(out), device))
      proposed.reasons.push_back(std::move(sentence));
  } catch (const std::exception&) {
    fs::remove(out);  // the scene cannot be built
    if (copied)
      fs::remove(sphere_file(out));
    throw;
  }
  return std::move(proposed.reasons);
}

int make_new(const NewOptions& o) {
  const fs::path out = fs::absolute(
      o.out.empty() ? fs::path(scene_proposal::scene_name(o.part.stem().string()) + ".yaml")
                    : o.out);
  for (const std::string& reason : write_scene(o, out))
    console::print_result("{}\n", reason);
  console::print_result(
      "\n"
      "Wrote {}{}. To run it:\n"
      "  voxtouch up {} --device {} --motion press --view\n",
      out.string(),
      o.tool.empty() ? fmt::format(" and the tool {}", sphere_file(out).filename().string()) : "",
      o.out.empty() ? out.filename().string() : out.string(), device_argument(o.device));
  return 0;
}

}  // namespace

void write_first_scene(const fs::path& part, const std::string& device, const fs::path& out) {
  NewOptions o;
  o.part = part, o.device = device;
  for (const std::string& reason : write_scene(o, out))
    console::log("  {}\n", reason);
}

void add_new(CLI::App& app, Action& action) {
  auto o = std::make_shared<NewOptions>();
  CLI::App* verb = app.add_subcommand("new");
  verb->add_option("PART", o->part, "Mesh of the part: OBJ, STL, PLY, glTF/GLB, COLLADA")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("TOOL", o->tool, "Mesh of the tool, gripped at its origin; default: sphere")
      ->check(CLI::ExistingFile);
  verb->add_option("--device", o->device, "Device name or device file")->capture_default_str();
  const CLI::IsMember units({scene_proposal::kMillimetre.name, scene_proposal::kMetre.name});
  verb->add_option("--unit", o->part_unit,
                   "Unit of the part's file; default: the file's unit, else guessed from the size")
      ->check(units);
  verb->add_option("--tool-unit", o->tool_unit, "Unit of the tool's file")->check(units);
  verb->add_option("--out", o->out,
                   "Scene file to write; default: PART's name with .yaml, in the current folder");
  verb->callback([o, &action] { action = [o] { return make_new(*o); }; });
}

}  // namespace voxtouch::cli

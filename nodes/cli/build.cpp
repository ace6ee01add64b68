#include <filesystem>
#include <ostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/mesh/import.hpp"
#include "core/pointshell/export.hpp"
#include "core/voxmap/voxelise.hpp"
#include "nodes/cli/output_file.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/parallel_for.hpp"

namespace voxtouch::cli {
namespace {

struct BuildOptions {
  std::filesystem::path mesh, out;
  double voxel_m = 0.0, scale = 1.0;
  std::vector<double> origin;
  bool json = false;
};

template <class Write>
void write_file(const std::filesystem::path& file, Write&& write) {
  OutputFile out(file);
  write(out.stream());
  out.keep();
}

struct Files {
  std::filesystem::path surface, interior, shell;
};

/// Makes the folder too.
Files write_files(const BuildOptions& o, const voxmap::Voxmap& voxmap,
                  const std::vector<pointshell::ShellPoint>& points) {
  std::error_code refused;
  std::filesystem::create_directories(o.out, refused);
  if (refused)
    throw std::runtime_error(fmt::format("Cannot create {} ({}). Choose another folder with --out",
                                         o.out.string(), refused.message()));
  const std::string stem = o.mesh.stem().string();
  const Files files{o.out / (stem + "_surface.csv"), o.out / (stem + "_interior.csv"),
                    o.out / (stem + "_shell.ply")};
  write_file(files.surface, [&](std::ostream& out) { pointshell::write_surface_csv(out, points); });
  write_file(files.interior,
             [&](std::ostream& out) { pointshell::write_interior_csv(out, voxmap); });
  write_file(files.shell, [&](std::ostream& out) { pointshell::write_shell_ply(out, points); });
  return files;
}

int build(const BuildOptions& o) {
  const auto log = [](const std::string& text) { console::log("{}\n", text); };
  log("reading " + o.mesh.string());
  mesh::ImportOptions options;
  options.scale = o.scale;
  options.voxel_size_m = o.voxel_m;
  const mesh::ImportedMesh imported =
      mesh::import_mesh(o.mesh, options, mesh_import::mesh_process());
  std::vector<std::string> warnings = imported.warnings;
  for (const std::string& sentence : imported.report.sentences())
    warnings.push_back(sentence);
  for (const std::string& warning : warnings)
    log("warning: " + warning);

  voxmap::Grid grid = voxmap::default_grid(imported.mesh, o.voxel_m);
  if (!o.origin.empty())
    grid.origin = Vec3(o.origin[0], o.origin[1], o.origin[2]);
  log(fmt::format("voxmap of {} triangles at {} m", imported.mesh.triangles.size(), o.voxel_m));
  const ParallelFor parallel_for = runtime::threaded_for();
  const voxmap::Voxmap voxmap = voxmap::voxelise(imported.mesh, grid, parallel_for);
  log(fmt::format("pointshell of {} surface voxels", voxmap.surface_count()));
  const std::vector<pointshell::ShellPoint> points =
      pointshell::shell_points(imported.mesh, grid, parallel_for);
  const Files files = write_files(o, voxmap, points);
  if (o.json) {
    nlohmann::ordered_json j;
    j["ok"] = true;
    j["mesh"] = o.mesh.string();
    j["triangles"] = imported.mesh.triangles.size();
    j["closed"] = imported.report.closed;
    j["voxel_size_m"] = o.voxel_m;
    j["origin_m"] = {grid.origin.x(), grid.origin.y(), grid.origin.z()};
    j["surface_voxels"] = voxmap.surface_count();
    j["interior_voxels"] = voxmap.interior_count();
    j["voxmap_bytes"] = voxmap.bytes();
    j["largest_gap_m"] = pointshell::largest_gap_m(points);
    j["files"] = {files.surface.string(), files.interior.string(), files.shell.string()};
    j["warnings"] = warnings;
    console::print_result("{}\n", j.dump(2));
  } else {
    console::print_result(
        "{} surface and {} interior voxels, {} kB; grid origin {} {} {} m\n  {}\n  {}\n  {}\n",
        voxmap.surface_count(), voxmap.interior_count(), voxmap.bytes() / 1024, grid.origin.x(),
        grid.origin.y(), grid.origin.z(), files.surface.string(), files.interior.string(),
        files.shell.string());
  }
  return 0;
}

}  // namespace

void add_build(CLI::App& app, Action& action) {
  auto o = std::make_shared<BuildOptions>();
  CLI::App* verb = app.add_subcommand("build");
  verb->add_option("MESH", o->mesh, "OBJ, STL, PLY, glTF/GLB or COLLADA")->required();
  verb->add_option("--voxel", o->voxel_m, "Voxel edge [m]")
      ->required()
      ->check(runtime::require_positive);
  verb->add_option(
          "--origin", o->origin,
          "Origin of the grid X,Y,Z [m]; default: one voxel outside the mesh's bounding box")
      ->delimiter(',')
      ->expected(3);
  verb->add_option("--scale", o->scale,
                   "Metres per unit of the file, such as 0.001 for millimetres")
      ->capture_default_str()
      ->check(runtime::require_positive);
  verb->add_option("--out", o->out, "Output folder")->required();
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout");
  verb->callback([o, &action] { action = [o] { return build(*o); }; });
}

}  // namespace voxtouch::cli

/// The Python package's own half in C++: core with arrays in and out. Errors are exceptions with
/// the sentences that the command line prints.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/mesh/import.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/device_file.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/version.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/object_grid.hpp"
#include "core/voxmap/voxelise.hpp"
#include "devices/registry.hpp"
#include "nodes/cli/design/design_input.hpp"
#include "nodes/mesh_import/mesh_process.hpp"

namespace py = pybind11;

namespace {

using namespace voxtouch;

template <class T>
using Array = py::array_t<T, py::array::c_style>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

mesh::TriangleReader reader(const std::string& program) {
  return mesh_import::mesh_process({.program = program});
}

template <class T>
Array<T> array_of(std::vector<py::ssize_t> shape) {
  return Array<T>(std::move(shape));
}
void put(double* row, const Vec3& v) { row[0] = v.x(), row[1] = v.y(), row[2] = v.z(); }

std::vector<Pose> poses_of(const Doubles& array) {
  if (array.ndim() != 2 || array.shape(1) != 7)
    throw std::invalid_argument(
        "poses must be an array of n rows of 7 numbers: qw, qx, qy, qz, x, y, z of the tool in the "
        "world [m]");
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(array.shape(0)));
  const double* v = array.data();
  for (py::ssize_t n = 0; n < array.shape(0); ++n, v += 7) {
    for (int i = 0; i < 7; ++i)
      if (!std::isfinite(v[i]))
        throw std::invalid_argument(
            fmt::format("poses[{}, {}] is {}, not a finite number", n, i, v[i]));
    Pose pose{Vec3(v[4], v[5], v[6]), Quat(v[0], v[1], v[2], v[3])};
    if (!normalise_within(pose.orientation, 1e-3, 1e3))
      throw std::invalid_argument(
          fmt::format("poses[{}]: the quaternion's norm is {}, limits 1e-3 to 1e3", n,
                      pose.orientation.norm()));
    poses.push_back(pose);
  }
  return poses;
}

py::dict probe(const std::string& file, const Doubles& array, const std::string& model_name,
               bool points, const std::string& program) {
  const std::vector<Pose> poses = poses_of(array);
  std::optional<contact::ContactModelKind> model;
  if (!model_name.empty() && !contact::parse_contact_model(model_name, model.emplace()))
    throw std::invalid_argument(
        fmt::format("unknown contact model '{}'; valid: original, adapted, field", model_name));
  const auto count = static_cast<py::ssize_t>(poses.size());
  auto surface = array_of<std::uint32_t>({count}), interior = array_of<std::uint32_t>({count});
  auto coherence = array_of<double>({count}), force = array_of<double>({count, 3}),
       torque = array_of<double>({count, 3});
  std::uint32_t *const s = surface.mutable_data(), *const in = interior.mutable_data();
  double *const c = coherence.mutable_data(), *const f = force.mutable_data(),
                *const t = torque.mutable_data();
  std::vector<std::vector<std::uint32_t>> hit(points ? poses.size() : 0);
  std::vector<std::string> warnings;
  {
    const py::gil_scoped_release others_may_run;
    const auto built = rendering::build_scene(scene::load_scene(file), serial_for(),
                                              {.model = model, .read = reader(program)});
    warnings = built->plan().warnings;
    std::vector<std::uint32_t> ids;
    for (std::size_t n = 0; n < poses.size(); ++n) {
      const contact::ContactResult r = built->contacts().probe(poses[n], ids);
      s[n] = static_cast<std::uint32_t>(r.surface_hits),
      in[n] = static_cast<std::uint32_t>(r.interior_hits), c[n] = r.coherence;
      put(f + 3 * n, r.wrench.force), put(t + 3 * n, r.wrench.torque);
      if (points)
        hit[n] = ids;
    }
  }
  py::dict out;
  out["surface_hits"] = surface, out["interior_hits"] = interior, out["coherence"] = coherence;
  out["force_n"] = force, out["torque_nm"] = torque, out["warnings"] = warnings;
  if (points) {
    py::list all;
    for (const auto& ids : hit)
      all.append(Array<std::uint32_t>(static_cast<py::ssize_t>(ids.size()), ids.data()));
    out["points"] = all;
  }
  return out;
}

py::dict build(const std::string& file, double voxel_m, double scale,
               const std::optional<std::array<double, 3>>& origin, const std::string& program) {
  for (const auto& [name, value] : {std::pair{"voxel", voxel_m}, {"scale", scale}})
    if (!(std::isfinite(value) && value > 0.0))
      throw std::invalid_argument(fmt::format("{} is {}; it must be a number > 0", name, value));
  mesh::ImportOptions options;
  options.scale = scale, options.voxel_size_m = voxel_m;
  mesh::ImportedMesh imported;
  voxmap::Grid grid;
  voxmap::Voxmap map;
  std::vector<pointshell::ShellPoint> shell;
  std::vector<std::array<std::int32_t, 3>> surface, interior;
  {
    const py::gil_scoped_release others_may_run;
    imported = mesh::import_mesh(file, options, reader(program));
    grid = voxmap::default_grid(imported.mesh, voxel_m);
    if (origin)
      grid.origin = Vec3((*origin)[0], (*origin)[1], (*origin)[2]);
    if (!grid.origin.allFinite())
      throw std::invalid_argument("origin must be three finite numbers [m]");
    map = voxmap::voxelise(imported.mesh, grid, serial_for());
    shell = pointshell::shell_points(imported.mesh, grid, serial_for());
    map.for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) {
      (kind == voxmap::VoxelKind::kInterior ? interior : surface).push_back({v.i, v.j, v.k});
    });
  }
  const auto voxels = [](const auto& list) {
    auto out = array_of<std::int32_t>({static_cast<py::ssize_t>(list.size()), 3});
    std::copy_n(list.empty() ? nullptr : list.front().data(), 3 * list.size(), out.mutable_data());
    return out;
  };
  const auto count = static_cast<py::ssize_t>(shell.size());
  auto point = array_of<double>({count, 3}), normal = array_of<double>({count, 3}),
       area = array_of<double>({count});
  for (std::size_t n = 0; n < shell.size(); ++n) {
    put(point.mutable_data() + 3 * n, shell[n].point),
        put(normal.mutable_data() + 3 * n, shell[n].normal);
    area.mutable_data()[n] = shell[n].area_m2;
  }
  std::vector<std::string> warnings = imported.warnings;
  for (const std::string& sentence : imported.report.sentences())
    warnings.push_back(sentence);
  auto corner = array_of<double>({3});
  put(corner.mutable_data(), grid.origin);
  py::dict out;
  out["voxel_m"] = voxel_m, out["origin_m"] = corner, out["closed"] = imported.report.closed;
  out["surface"] = voxels(surface), out["interior"] = voxels(interior);
  out["points_m"] = point, out["normals"] = normal, out["areas_m2"] = area,
  out["warnings"] = warnings;
  return out;
}

/// The report of `voxtouch design --json` as text.
std::string design(const std::string& device, const std::string& scene, const std::string& hand,
                   const std::string& kind, double cutoff_hz, double gain_margin,
                   double stiffness_n_per_m, bool gripped, bool damping,
                   const std::string& program) {
  const auto one_of = [](std::string_view name, const std::string& value,
                         std::initializer_list<std::string_view> words) {
    if (std::ranges::find(words, value) == words.end())
      throw std::invalid_argument(
          fmt::format("{}: '{}' is not one of {}", name, value, fmt::join(words, ", ")));
  };
  one_of("hand", hand, {"", "pen", "arm", "any_passive"});
  one_of("kind", kind, {"auto", "shaping_filter", "spring_damper", "direct"});
  if (!(cutoff_hz > 0.0 && std::isfinite(cutoff_hz)))
    throw std::invalid_argument(fmt::format("cutoff_hz is {}; it must be a number > 0", cutoff_hz));
  if (!(gain_margin >= 1.0 && gain_margin <= 100.0))
    throw std::invalid_argument(fmt::format("gain_margin is {}, limits 1 to 100", gain_margin));
  if (!(stiffness_n_per_m >= 0.0 && std::isfinite(stiffness_n_per_m)))
    throw std::invalid_argument(
        fmt::format("stiffness_n_per_m is {}; it must be >= 0", stiffness_n_per_m));
  const bool is_file = device.ends_with(".yaml") || device.ends_with(".yml");
  const DeviceDescription description =
      is_file ? scene::load_device_file(device).description : devices::describe_device(device);
  cli::DesignInput input;
  input.scene = scene, input.hand = hand, input.kind = kind, input.cutoff_hz = cutoff_hz,
  input.gain_margin = gain_margin;
  input.stiffness_n_per_m = stiffness_n_per_m, input.gripped = gripped, input.no_damping = !damping;
  const auto build = [&](const scene::Scene& requested) {
    return rendering::build_scene(requested, serial_for(), {.read = reader(program)});
  };
  return cli::to_json(cli::work_out(input, coupling::design::model_of(description), build)).dump();
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "C++ part of voxtouch: use the functions of the package.";
  m.attr("version") = std::string(version());
  m.def("probe", &probe);
  m.def("build", &build);
  m.def("design", &design, py::call_guard<py::gil_scoped_release>());
}

#include "core/scene/device_file.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/scene/device_figures.hpp"
#include "core/scene/map_reader.hpp"
#include "core/scene/text_file.hpp"

namespace voxtouch::scene {
namespace {

/// The guard fades the largest force within 20 ms; the slew limit leaves it a third more than that
/// takes.

/// Reads figures of one map, and notes each that is left out and has a standard.
class FigureReader {
 public:
  FigureReader(const SceneSource& source, const MapReader& map, bool pen, DeviceFile& file)
      : source_(source),
        map_(map),
        pen_(pen),
        file_(file) {}

  double number(std::string_view key) const {
    return map_.has(key) ? map_.get<double>(key) : standard(key);
  }
  std::size_t count(std::string_view key) const {
    return map_.has(key) ? map_.get<std::size_t>(key) : static_cast<std::size_t>(standard(key));
  }
  /// A number, or [low, high] with 0 < low <= high.
  void range(std::string_view key, double& low, double& high) const {
    const YamlNode* value = map_.find(key);
    if (value == nullptr)
      return void(low = high = standard(key));
    if (value->kind == YamlNode::Kind::kScalar) {
      low = high = read_number(source_, *value, key);
      if (!(low > 0.0))
        source_.fail(value->place, fmt::format("'{}' is {}; it must be above 0.", key, low));
      return;
    }
    const auto given = map_.get<std::array<double, 2>>(key);
    if (!(given[0] > 0.0))
      source_.fail(value->place,
                   fmt::format("'{}' starts at {}; it must be above 0.", key, given[0]));
    low = given[0], high = given[1];
  }

 private:
  double standard(std::string_view key) const {
    const DeviceFigure& figure = device_figure(key);
    const double value = (pen_ ? figure.pen_standard : figure.arm_standard).value();
    file_.assumed.push_back(fmt::format("{} {}", key, value));
    return value;
  }

  const SceneSource& source_;
  const MapReader& map_;
  bool pen_;
  DeviceFile& file_;
};

/// Reports all missing figures in one error.
void require_all(const SceneSource& source, const YamlNode& root, const MapReader& map) {
  std::vector<std::string> missing;
  for (const Key& key : keys::device_file.keys)
    if (key.rule == KeyRule::kRequired && !map.has(key.name))
      missing.push_back(to_sentence(device_figure(key.name)));
  if (missing.empty())
    return;
  source.fail(
      root.place,
      fmt::format("{} missing in the device file:\n  {}",
                  missing.size() == 1 ? "1 key is" : fmt::format("{} keys are", missing.size()),
                  fmt::join(missing, "\n  ")));
}

void read_translation(const MapReader& map, const FigureReader& read, DeviceDescription& d) {
  map.read("max_force_n", d.max_force_n);
  map.read("max_stiffness_n_per_m", d.max_stiffness_n_per_m);
  read.range("mass_kg", d.mass_min_kg, d.mass_max_kg);
  d.damping_ns_per_m = read.number("damping_ns_per_m");
  d.coulomb_friction_n = read.number("coulomb_friction_n");
  map.read("position_resolution_m", d.position_resolution_m);
  d.force_bandwidth_hz = std::numeric_limits<double>::infinity();
  map.read("force_bandwidth_hz", d.force_bandwidth_hz);
}

void read_rotation(const FigureReader& read, DeviceDescription& d) {
  d.output_dof = 6;
  read.range("inertia_kg_m2", d.inertia_min_kg_m2, d.inertia_max_kg_m2);
  d.damping_nms_per_rad = read.number("damping_nms_per_rad");
  d.coulomb_friction_nm = read.number("coulomb_friction_nm");
  d.orientation_resolution_rad = read.number("orientation_resolution_rad");
  d.max_stiffness_nm_per_rad = read.number("max_stiffness_nm_per_rad");
}

void read_timing(const MapReader& map, const FigureReader& read, DeviceDescription& d) {
  d.rate_hz = map.get<double>("rate_hz");
  d.delay_s = read.number("delay_s");
  d.jitter = read.number("jitter");
  d.consecutive_losses = static_cast<std::uint32_t>(read.count("consecutive_losses"));
}

}  // namespace

DeviceFile parse_device_file(const std::string& text, const std::filesystem::path& file) {
  const SceneSource source{file, {}};
  const YamlNode root = parse_yaml(text, file, "device file");
  if (root.kind == YamlNode::Kind::kNull)
    source.fail({1, 1}, "The device file is empty; its first line is 'device: <name>'.");
  const MapReader map(source, root, "device file", keys::device_file);
  require_all(source, root, map);
  DeviceFile out;
  DeviceDescription& d = out.description;
  d.simulated = true;
  map.read("device", d.model);
  const bool pen = map.choice("grip") == 0;
  d.grip = pen ? "pen" : "arm";
  const FigureReader read(source, map, pen, out);
  read_timing(map, read, d);
  read_translation(map, read, d);
  d.max_torque_nm = map.get<double>("max_torque_nm");
  if (d.max_torque_nm > 0.0) {
    YamlNode nothing;
    nothing.kind = YamlNode::Kind::kMap;
    const MapReader rotation = map.has("rotation")
                                   ? map.inner("rotation")
                                   : MapReader(source, nothing, "rotation", keys::device_rotation);
    read_rotation(FigureReader(source, rotation, pen, out), d);
  } else {
    map.refuse("rotation",
               "requires 'max_torque_nm' above 0: a device without torque cannot resist rotation.");
  }
  if (map.has("workspace_m"))
    map.read("workspace_m", out.workspace_m.emplace());
  if (map.has("measured")) {
    const MapReader measured = map.inner("measured");
    out.measured =
        Measurement{measured.get<std::string>("date"), measured.get<std::string>("command"), {}};
    measured.read("serial", out.measured->serial);
  }
  derive_slew_limits(d);
  return out;
}

DeviceFile load_device_file(const std::filesystem::path& file) {
  return parse_device_file(read_text_file(file, "device"), file);
}

std::string assumed_sentence(const DeviceFile& file) {
  if (file.assumed.empty())
    return {};
  return fmt::format("the device file of {} omits keys; assumed values of {}: {}",
                     file.description.model, file.description.grip == "pen" ? "a stylus" : "an arm",
                     fmt::join(file.assumed, ", "));
}

std::string measured_sentence(const DeviceFile& file) {
  if (!file.measured)
    return {};
  return fmt::format("the figures of {} were measured on {} by: {}", file.description.model,
                     file.measured->date, file.measured->command);
}

std::string other_device(const DeviceFile& file, const DeviceDescription& driver,
                         std::string_view serial) {
  const DeviceDescription& d = file.description;
  constexpr double kSameRate = 0.01;
  if (d.model != driver.model)
    return fmt::format("it is of '{}', the device is '{}'", d.model, driver.model);
  if (file.measured && !file.measured->serial.empty() && !serial.empty() &&
      file.measured->serial != serial)
    return fmt::format("it is of the {} with serial number '{}', this one has '{}'", d.model,
                       file.measured->serial, serial);
  if (!(std::abs(d.rate_hz - driver.rate_hz) <= kSameRate * driver.rate_hz))
    return fmt::format("it is of {:.6g} Hz, the device runs at {:.6g} Hz", d.rate_hz,
                       driver.rate_hz);
  if (d.grip != driver.grip)
    return fmt::format("it is of grip '{}', the device has '{}'", d.grip, driver.grip);
  if ((d.max_torque_nm > 0.0) != (driver.max_torque_nm > 0.0))
    return fmt::format("it is of {:.6g} Nm, the device gives {:.6g} Nm", d.max_torque_nm,
                       driver.max_torque_nm);
  return {};
}

DeviceDescription measured_device(const DeviceFile& file, const DeviceDescription& driver) {
  DeviceDescription d = file.description;
  d.max_force_n = std::min(d.max_force_n, driver.max_force_n);
  d.max_torque_nm = std::min(d.max_torque_nm, driver.max_torque_nm);
  d.max_stiffness_n_per_m = std::min(d.max_stiffness_n_per_m, driver.max_stiffness_n_per_m);
  if (d.max_torque_nm > 0.0)
    d.max_stiffness_nm_per_rad =
        std::min(d.max_stiffness_nm_per_rad, driver.max_stiffness_nm_per_rad);
  else
    d.orientation_resolution_rad = driver.orientation_resolution_rad;
  d.network_delay_s = driver.network_delay_s;
  d.input_dof = driver.input_dof, d.output_dof = driver.output_dof;
  d.simulated = driver.simulated;
  if (!d.simulated)
    d.delay_s = std::max(0.0, d.delay_s - 1.0 / d.rate_hz);
  derive_slew_limits(d);
  return d;
}

}  // namespace voxtouch::scene

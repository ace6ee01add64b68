#include "core/scene/device_file.hpp"

#include <fmt/core.h>

#include "core/scene/map_reader.hpp"
#include "core/scene/text_file.hpp"

namespace voxtouch::scene {
namespace {

/// `key` holds [low, high] with 0 < low <= high.
void read_inertia(const SceneSource& source, const MapReader& map, std::string_view key, coupling::design::AxisModel& axis) {
  const auto range = map.get<std::array<double, 2>>(key);
  if (!(range[0] > 0.0))
    source.fail(map.require(key).place, fmt::format("'{}' begins at {}; it must be above 0.", key, range[0]));
  axis.inertia_min = range[0], axis.inertia_max = range[1];
}

coupling::design::AxisModel read_rotation(const SceneSource& source, const MapReader& map) {
  coupling::design::AxisModel axis;
  read_inertia(source, map, "inertia_kg_m2", axis);
  map.read("damping_nms_per_rad", axis.damping);
  map.read("coulomb_friction_nm", axis.coulomb_friction);
  map.read("orientation_resolution_rad", axis.resolution);
  map.read("max_stiffness_nm_per_rad", axis.max_stiffness);
  return axis;
}

coupling::design::AxisModel read_translation(const SceneSource& source, const MapReader& map) {
  coupling::design::AxisModel axis;
  map.read("max_force_n", axis.max_effort);
  map.read("max_stiffness_n_per_m", axis.max_stiffness);
  read_inertia(source, map, "mass_kg", axis);
  map.read("damping_ns_per_m", axis.damping);
  map.read("coulomb_friction_n", axis.coulomb_friction);
  map.read("position_resolution_m", axis.resolution);
  map.read("force_bandwidth_hz", axis.effort_bandwidth_hz);
  return axis;
}

coupling::design::LoopTiming read_timing(const MapReader& map) {
  coupling::design::LoopTiming timing;
  timing.period_s = 1.0 / map.get<double>("rate_hz");
  map.read("delay_s", timing.delay_s);
  map.read("jitter", timing.jitter);
  timing.lost_in_a_row = static_cast<int>(map.get<std::size_t>("lost_in_a_row"));
  return timing;
}

}  // namespace

coupling::design::DeviceModel parse_device_file(const std::string& text, const std::filesystem::path& file) {
  const SceneSource source{file, {}};
  const YamlNode root = parse_yaml(text, file, "device file");
  if (root.kind == YamlNode::Kind::kNull)
    source.fail({1, 1}, "The device file is empty; it begins with 'device: <name>'.");
  const MapReader map(source, root, "device file", keys::device_file);
  coupling::design::DeviceModel model;
  map.read("device", model.name);
  model.timing = read_timing(map);
  model.translation = read_translation(source, map);
  const double torque = map.get<double>("max_torque_nm");
  model.gives_torque = torque > 0.0;
  if (model.gives_torque) {
    model.rotation = read_rotation(source, map.inner("rotation"));
    model.rotation.max_effort = torque;
  } else {
    map.refuse("rotation", "does not go with 'max_torque_nm: 0': a device without torque cannot act against rotation.");
  }
  model.rotation.effort_bandwidth_hz = model.translation.effort_bandwidth_hz;
  model.grip = map.choice("grip") == 0 ? coupling::design::Grip::kPen : coupling::design::Grip::kArm;
  return model;
}

coupling::design::DeviceModel load_device_file(const std::filesystem::path& file) {
  return parse_device_file(read_text_file(file, "device"), file);
}

}  // namespace voxtouch::scene

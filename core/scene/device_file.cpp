#include "core/scene/device_file.hpp"

#include <fmt/core.h>

#include "core/scene/map_reader.hpp"
#include "core/scene/text_file.hpp"

namespace voxtouch {
namespace {

/// Above these a number is in the wrong unit (milliseconds, millimetres, per cent), not the property of a haptic device.
constexpr double kLongestDelayS = 1.0, kCoarsestM = 0.01, kCoarsestRad = 0.1, kLargestJitter = 10.0;
constexpr double kSlowestHz = 1.0, kFastestHz = 1e5;
constexpr std::uint64_t kMaxLost = 1000;

class DeviceReader {
 public:
  DeviceReader(const SceneSource& source, const MapReader& map) : source_(source), map_(map) {}

  double positive(std::string_view key) const { return read_positive(source_, map_.require(key), key); }
  double not_negative(std::string_view key) const { return read_not_negative(source_, map_.require(key), key); }
  double at_most(std::string_view key, double largest, std::string_view unit) const {
    const double value = not_negative(key);
    if (value > largest)
      source_.fail(map_.require(key).place,
                   fmt::format("'{}' is {}; it is in {} and must be at most {}.", key, value, unit, largest));
    return value;
  }
  /// [low, high] with 0 < low <= high.
  void inertia(std::string_view key, AxisModel& axis) const {
    const YamlNode& node = map_.require(key);
    const auto range = read_range(source_, node, key);
    if (!(range[0] > 0.0))
      source_.fail(node.place, fmt::format("'{}' begins at {}; it must be above 0.", key, range[0]));
    axis.inertia_min = range[0], axis.inertia_max = range[1];
  }

 private:
  const SceneSource& source_;
  const MapReader& map_;
};

AxisModel read_rotation(const SceneSource& source, const YamlNode& node) {
  const MapReader map(source, node, "rotation",
                      {"inertia_kg_m2", "damping_nms_per_rad", "coulomb_friction_nm", "orientation_resolution_rad",
                       "max_stiffness_nm_per_rad"});
  const DeviceReader read(source, map);
  AxisModel axis;
  read.inertia("inertia_kg_m2", axis);
  axis.damping = read.not_negative("damping_nms_per_rad");
  axis.coulomb_friction = read.not_negative("coulomb_friction_nm");
  axis.resolution = read.at_most("orientation_resolution_rad", kCoarsestRad, "radians");
  axis.max_stiffness = read.positive("max_stiffness_nm_per_rad");
  return axis;
}

AxisModel read_translation(const DeviceReader& read) {
  AxisModel axis;
  axis.max_effort = read.positive("max_force_n");
  axis.max_stiffness = read.positive("max_stiffness_n_per_m");
  read.inertia("mass_kg", axis);
  axis.damping = read.not_negative("damping_ns_per_m");
  axis.coulomb_friction = read.not_negative("coulomb_friction_n");
  axis.resolution = read.at_most("position_resolution_m", kCoarsestM, "metres");
  return axis;
}

LoopTiming read_timing(const SceneSource& source, const MapReader& map, const DeviceReader& read) {
  LoopTiming timing;
  const double rate = read.positive("rate_hz");
  if (rate < kSlowestHz || rate > kFastestHz)
    source.fail(map.require("rate_hz").place,
                fmt::format("'rate_hz' is {}; it must be from {} to {}.", rate, kSlowestHz, kFastestHz));
  timing.period_s = 1.0 / rate;
  timing.delay_s = read.at_most("delay_s", kLongestDelayS, "seconds");
  timing.jitter = read.at_most("jitter", kLargestJitter, "parts of the period");
  const YamlNode& lost = map.require("lost_in_a_row");
  const std::uint64_t count = read_count(source, lost, "lost_in_a_row");
  if (count > kMaxLost)
    source.fail(lost.place, fmt::format("'lost_in_a_row' is {}; it must be at most {}.", count, kMaxLost));
  timing.lost_in_a_row = static_cast<int>(count);
  return timing;
}

}  // namespace

DeviceModel parse_device_file(const std::string& text, const std::filesystem::path& file) {
  const SceneSource source{file, {}};
  const YamlNode root = parse_yaml(text, file, "device file");
  if (root.kind == YamlNode::Kind::kNull)
    source.fail({1, 1}, "The device file is empty; it begins with 'device: <name>'.");
  const MapReader map(source, root, "device file",
                      {"device", "rate_hz", "max_force_n", "max_torque_nm", "max_stiffness_n_per_m", "mass_kg",
                       "damping_ns_per_m", "coulomb_friction_n", "position_resolution_m", "delay_s",
                       "force_bandwidth_hz", "rotation", "jitter", "lost_in_a_row", "grip"});
  const DeviceReader read(source, map);
  DeviceModel model;
  model.name = read_text(source, map.require("device"), "device");
  model.timing = read_timing(source, map, read);
  model.translation = read_translation(read);
  const double torque = read.not_negative("max_torque_nm");
  model.gives_torque = torque > 0.0;
  if (model.gives_torque) {
    model.rotation = read_rotation(source, map.require("rotation"));
    model.rotation.max_effort = torque;
  } else {
    map.refuse("rotation", "does not go with 'max_torque_nm: 0': a device without torque cannot act against rotation.");
  }
  map.optional("force_bandwidth_hz", model.translation.effort_bandwidth_hz, read_positive);
  model.rotation.effort_bandwidth_hz = model.translation.effort_bandwidth_hz;
  model.grip = read_choice(source, map.require("grip"), "grip", {"pen", "arm"}) == 0 ? Grip::kPen : Grip::kArm;
  return model;
}

DeviceModel load_device_file(const std::filesystem::path& file) {
  return parse_device_file(read_text_file(file, "device"), file);
}

}  // namespace voxtouch

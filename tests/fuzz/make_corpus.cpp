// make_corpus FOLDER: some valid inputs of every fuzz target, written by the project's writers
// where possible. Inputs found by a fuzzer are stored there as `found_*` and are not changed.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/lwr_arm.hpp"
#include "devices/operator/hand_file.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/fuzz/wire.hpp"
#include "tests/unit/mesh/samples.hpp"

namespace {

using namespace voxtouch;
namespace fs = std::filesystem;

fs::path g_root;

void put(const std::string& target, const std::string& name, const std::string& bytes) {
  fs::create_directories(g_root / target);
  std::ofstream(g_root / target / name, std::ios::binary) << bytes;
}

template <class T>
std::string raw(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// The body of a message's CDR, without its header.
template <class T>
class Encoder {
 public:
  std::string operator()(const T& message) { return form_.bytes(message).substr(4); }

 private:
  bus::WireForm<T> form_{fuzz::participant()};
};

void meshes() {
  const mesh::TriangleMesh solid = samples::tetrahedron();
  const auto with = [](int format, int options, const std::string& bytes) {
    return std::string{static_cast<char>(format), static_cast<char>(options)} + bytes;
  };
  put("mesh", "obj", with(0, 0, samples::obj_text(solid)));
  put("mesh", "obj_polygons",
      with(0, 4,
           "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2/1/1 3/1/1 "
           "4/1/1\nl 1 2\np 3\nf -4 -3 "
           "-2\n"));
  put("mesh", "stl_text", with(1, 1, samples::text_stl(solid)));
  put("mesh", "stl_binary", with(1, 2, samples::binary_stl(solid)));
  const std::string ply_head =
      "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float "
      "y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  put("mesh", "ply_text",
      with(2, 0, ply_head + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"));
  put("mesh", "ply_binary",
      with(2, 0,
           "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty "
           "float y\nproperty float "
           "z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
               samples::little({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) + "\3" +
               samples::little({0, 1, 2})));
  put("mesh", "refused_obj", with(0, 0, "v 0 0 0\nv 1e39 0 0\nv 0 nan 0\nf 1 2 3\n"));
  put("mesh", "refused_ply_corner",
      with(2, 0,
           ply_head + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 99999999\n"));
  const std::string l = "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 2 1 0\nv 2 2 0\nv 0 2 0\n";
  put("mesh", "obj_concave", with(0, 0, "\xef\xbb\xbf" + l + "f 2 3 4 5 6 1\nf 6 5 4 3 2 1\n"));
  put("mesh", "obj_bridge",
      with(0, 0, l + "v 1 0.5 0\nv 1 1 0\nv 1.5 0.5 0\nF 1 2 3 4 5 6 1 7 8 9 7\n"));
  put("mesh", "refused_obj_crossing", with(0, 0, l + "f 1 2 3\nf 1 4 2 3 5\n"));
  put("mesh", "stl_capitals",
      with(1, 0,
           "SOLID A\nFACET NORMAL -NAN(IND) 0 0\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 "
           "1 0\nENDLOOP\nENDFACET\nEND "
           "SOLID A\n"));
  put("mesh", "stl_tail", with(1, 0, samples::binary_stl(solid) + "tail"));
  put("mesh", "refused_ply_strips",
      with(2, 0,
           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
           "float z\nelement tristrips "
           "1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2 "
           "-1\n"));
  samples::Gltf gltf;
  put("mesh", "glb", with(4, 0, gltf.glb()));
  gltf.buffer =
      R"({"byteLength":72,"uri":"data:application/octet-stream;base64,)"
      R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAAADAAIAAQACAAMA"})";
  gltf.nodes = R"([{"mesh":0,"scale":[1,-1,2],"children":[1]},{"mesh":0,"translation":[1,0,0]}])";
  put("mesh", "gltf", with(3, 0, gltf.json()));
  samples::Collada collada;
  collada.unit = R"(<unit name="millimeter" meter="0.001"/>)";
  put("mesh", "dae", with(5, 0, collada.xml()));
  collada.kind = "polygons", collada.faces = "1",
  collada.p = "</p><ph><p>0 1 2</p><h>3 1 2</h></ph><p>";
  put("mesh", "dae_hole", with(5, 0, collada.xml()));
}

void scenes(const fs::path& deploy) {
  for (const char* name : {"plane", "block"}) {
    std::ifstream in(deploy / "scenes" / (std::string(name) + ".yaml"), std::ios::binary);
    put("scene", name, std::string(std::istreambuf_iterator<char>(in), {}));
  }
  const std::string head =
      "scene: s\nvoxel_size: 0.002\nstatic: [{mesh: ../meshes/block.obj, scale: 2, position: [0, "
      "0, 1], orientation: "
      "[1, 0, 0, 0]}]\n"
      "dynamic: {mesh: ../meshes/block.obj, shell: naive}\n";
  put("scene", "objects",
      head +
          "contact: {model: adapted, stiffness_n_per_m: 30}\n"
          "effects:\n  - friction: {coulomb: 0.5, stiffness_n_per_m: 150}\n    object: ground\n"
          "  - magnet: {point: [0, 0, 0.05], radius_m: 0.02, force_n: 1}\n    region: {sphere: "
          "{centre: [0, 0, 0.05], "
          "radius: 0.1}, blend_m: 0.01}\n"
          "  - viscosity: {damping_ns_per_m: 1}\n    gain: 0.5\n    on: false\n    name: oil\n");
  put("scene", "by_hand",
      head +
          "contact: {model: field, stiffness_n_per_m3: 1.2e6}\n"
          "coupling: {kind: shaping_filter, cutoff_hz: 50, damping_ratio: 0.8, gain: 0.5, "
          "stiffness_cap_n_per_m: 800, "
          "injected_damping_ns_per_m: 3, velocity_filter_hz: 100}\n"
          "device: {position_scale: 10, force_scale: 0.5, pose: {position: [0, 0, 1]}, "
          "clutch_button: 1}\n"
          "motions:\n  a: {path: [[0, 0, 0], [0.1, 0, 0]], circle: {centre: [0, 0, 0], axis: [0, "
          "0, 1]}, "
          "speed_m_per_s: 0.05}\n");
  put("scene", "designed",
      head +
          "contact: {model: field, stiffness_n_per_m3: 1e6}\n"
          "coupling: {design: auto, kind: auto, cutoff_hz: 5, gain_margin: 2, released: true, "
          "hand: {mass_kg: [0.02, "
          "0.2], "
          "damping_ns_per_m: [0.5, 8], stiffness_n_per_m: [20, 800]}}\n");
  for (const char* zero :
       {"voxel_size: 0", "voxel_size: .inf", "voxel_size: 1e999", "voxel_size: -1"}) {
    std::string text = head + "contact: {model: field, stiffness_n_per_m3: 1e6}\n";
    text.replace(text.find("voxel_size: 0.002"), 17, zero);
    put("scene", "refused_" + std::string(zero).substr(12), text);
  }
  std::ifstream in(deploy / "devices/premium_3.yaml", std::ios::binary);
  const std::string premium(std::istreambuf_iterator<char>(in), {});
  put("device_file", "premium_3", premium);
  std::string late = premium;
  late.replace(late.find("delay_s:"), 8, "delay_s: 1000 #");
  put("device_file", "refused_delay", late);
  put("device_file", "with_torque",
      "device: t\nrate_hz: 500\nmax_force_n: 10\nmax_torque_nm: 1\nmax_stiffness_n_per_m: "
      "1000\nmass_kg: [0.1, 0.2]\n"
      "damping_ns_per_m: 0.1\ncoulomb_friction_n: 0\nposition_resolution_m: 1e-5\ndelay_s: "
      "0.002\nforce_bandwidth_hz: "
      "50\n"
      "rotation: {inertia_kg_m2: [1e-4, 2e-4], damping_nms_per_rad: 0.001, coulomb_friction_nm: 0, "
      "orientation_resolution_rad: 1e-4, "
      "max_stiffness_nm_per_rad: 1}\njitter: 0.2\nconsecutive_losses: 2\ngrip: arm\n");
}

msg::ForceCommand command(std::uint64_t n) {
  msg::ForceCommand m{};
  m.session_id = 7, m.sequence_number = n;
  m.sample_time_ns = static_cast<std::int64_t>(n) * 1'000'000,
  m.valid_until_ns = m.sample_time_ns + 5'000'000;
  m.wrench = {{1.0 + 0.1 * static_cast<double>(n), -2.0, 0.5}, {0.01, 0.0, -0.02}};
  return m;
}

msg::ContactState contact(std::uint64_t n) {
  msg::ContactState m{};
  m.session_id = 7, m.sequence_number = n,
  m.sample_time_ns = static_cast<std::int64_t>(n) * 1'000'000;
  m.tool_pose = m.object_pose =
      runtime::to_msg(Pose{Vec3(0.0, 0.0, -1e-4 * static_cast<double>(n)), Quat::Identity()});
  m.wrench.force.z = 0.02 * static_cast<double>(n), m.wrench.torque.x = 0.001;
  m.stiffness_bound_n_per_m = 200.0;
  Mat6 stiffness = Mat6::Zero();
  stiffness.diagonal() << 1.0, 1.0, 200.0, 0.01, 0.01, 0.001;
  runtime::to_msg(stiffness, m.stiffness);
  m.supplied_energy_j = 1e-6 * static_cast<double>(n);
  return m;
}

msg::DeviceState state(std::uint64_t n) {
  msg::DeviceState m{};
  m.session_id = 7, m.sequence_number = n,
  m.sample_time_ns = static_cast<std::int64_t>(n) * 1'000'000;
  m.pose = runtime::to_msg(
      Pose{Vec3(0.001 * static_cast<double>(n), 0.0, 0.01), Quat(0.5, 0.5, -0.5, 0.5)});
  m.twist = runtime::to_msg(Twist{Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.1, 0.0)});
  m.buttons = n % 4 == 3 ? 1U : 0U;
  return m;
}

void ring() {
  Encoder<msg::ForceCommand> commands;
  Encoder<msg::ContactState> contacts;
  Encoder<msg::DeviceState> states;
  std::string force, touch(1, '\0'), pose;
  for (std::uint64_t n = 0; n < 6; ++n)
    force += commands(command(n)), touch += contacts(contact(n)), pose += states(state(n));
  put("force_command", "six", force);
  put("device_state", "six", pose);
  for (const int choice : {0, 4 + 8 + 16 + 1, 8 + 2}) {
    touch[0] = static_cast<char>(choice);
    put("contact_state", "six_" + std::to_string(choice), touch);
  }
}

void changes() {
  Encoder<msg::EffectChange> encode;
  std::string all;
  const auto add = [&](std::uint32_t action, const std::string& effect,
                       const std::string& parameter, double value) {
    msg::EffectChange m{};
    m.request = 1, m.action = action;
    m.effect = runtime::lend(effect), m.parameter = runtime::lend(parameter);
    const std::string none;
    m.model = runtime::lend(none);
    m.value[0] = m.value[2] = value;
    const std::string body = encode(m);
    all += static_cast<char>(body.size());
    all += body;
  };
  add(1, "viscosity", "", 1.0);
  add(2, "friction", "", 0.5);
  add(3, "viscosity", "damping_ns_per_m", 2.0);
  add(3, "guide_plane", "normal", 1.0);
  add(3, "magnet", "force_n", 0.5);
  add(3, "texture", "force_n", 0.1);
  put("effect_change", "six", all);
}

void plans() {
  Encoder<msg::DeviceDescription> descriptions;
  Encoder<msg::ScenePlan> encode;
  const std::string model = "stylus", grip = "pen", text = "plane";
  msg::DeviceDescription d{};
  d.session_id = 7, d.model = runtime::lend(model), d.grip = runtime::lend(grip);
  d.rate_hz = 1000.0, d.max_force_n = 8.5, d.max_stiffness_n_per_m = 800.0;
  d.mass_min_kg = 0.05, d.mass_max_kg = 0.1, d.damping_ns_per_m = 0.01,
  d.position_resolution_m = 3e-5;
  d.delay_s = 1e-3, d.force_bandwidth_hz = 1e9, d.jitter = 0.2, d.consecutive_losses = 1,
  d.simulated = true;
  msg::ScenePlan p{};
  p.session_id = 7, p.scene = p.scene_hash = p.contact_model = runtime::lend(text);
  p.one_point_stiffness_n_per_m = 10.0, p.all_points_stiffness_n_per_m = 1000.0;
  p.one_point_stiffness_nm_per_rad = 0.01, p.all_points_stiffness_nm_per_rad = 1.0;
  const auto both = [&](int choice) {
    const std::string description = descriptions(d);
    return std::string(1, static_cast<char>(choice)) +
           raw(static_cast<std::uint16_t>(description.size())) + description + encode(p);
  };
  put("plan", "by_hand", both(0));
  d.max_torque_nm = 0.5, d.inertia_min_kg_m2 = d.inertia_max_kg_m2 = 1e-4,
  d.damping_nms_per_rad = 1e-3;
  d.max_stiffness_nm_per_rad = 0.3;
  put("plan", "with_torque", both(0));
  put("plan", "designed", both(63));
}

void packets() {
  lwr::fri::MsrPacket msr = lwr::fri::empty_msr();
  msr.interface.state = lwr::fri::State::kMon;
  msr.data.jnt_pos = lwr::fri::to_wire(lwr::lwr_rest_posture());
  lwr::fri::CmdPacket cmd = lwr::fri::empty_cmd();
  cmd.command.cmd_flags = lwr::fri::kFlagJntPos | lwr::fri::kFlagJntTrq;
  put("fri", "measurement", "\1" + raw(msr));
  put("fri", "command", "\1" + raw(cmd));
  put("fri", "joint", std::string(40, '\0'));
  std::string patched(
      12, '\0');  // force flows by then: a joint angle that is none, for one measurement
  patched += '\1' + raw(static_cast<std::uint16_t>(216)) + '\4' +
             raw(std::numeric_limits<float>::quiet_NaN());
  put("fri", "not_a_number", patched + std::string(12, '\0'));
  std::string talk;
  for (int n = 0; n < 600; ++n)
    talk += static_cast<char>((n * 37 + n / 7) % 200);
  put("phantom", "talk", talk);
  put("phantom", "still", std::string(600, '\0'));
}

void bag_in(bag::Storage storage) {
  const fs::path folder =
      fs::temp_directory_path() / ("voxtouch_corpus_" + std::to_string(getpid()));
  {
    auto writer = bag::BagWriter::create(folder, {.storage = storage}).value();
    const auto add = [&](const char* name, std::string_view type) {
      bag::TopicInfo topic;
      topic.name = name, topic.type = type, topic.serialization_format = "cdr";
      return writer.add_topic(topic).value();
    };
    const auto force = add("/haptic/coupling/command", msg::Type<msg::ForceCommand>::ros_name);
    const auto pose = add("/haptic/device/state", msg::Type<msg::DeviceState>::ros_name);
    Encoder<msg::ForceCommand> commands;
    Encoder<msg::DeviceState> states;
    const std::string head("\0\1\0\0", 4);
    for (std::uint64_t n = 0; n < 4; ++n) {
      const std::string f = head + commands(command(n)), p = head + states(state(n));
      (void)writer.append(force, static_cast<std::int64_t>(n), std::as_bytes(std::span(f)));
      (void)writer.append(pose, static_cast<std::int64_t>(n), std::as_bytes(std::span(p)));
    }
    (void)writer.append(force, 9, std::as_bytes(std::span("short", 5)));
    (void)writer.close();
  }
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    if (entry.path().extension() == ".db3")
      put("bag", "database", std::string(1, '\0') + bytes);
    if (entry.path().extension() == ".mcap")
      put("bag", "mcap", std::string(1, '\0') + bytes);
    if (entry.path().filename() == "metadata.yaml" && storage == bag::Storage::kSqlite3)
      put("bag", "metadata", "\1" + bytes);
  }
  fs::remove_all(folder);
}

void bags() {
  for (const bag::StorageName& one : bag::kStorages)
    bag_in(one.storage);
}

void numbers() {
  put("numbers", "setting_number", std::string(1, '\0') + "n=0.001");
  put("numbers", "setting_vector", std::string(1, '\0') + "v=1,-2e-3,.5");
  put("numbers", "setting_port", std::string(1, '\0') + "p=49938");
  put("numbers", "refused_number", std::string(1, '\0') + "n=inf");
  put("numbers", "refused_vector", std::string(1, '\0') + "v=0,nan,1");
  put("numbers", "refused_pose", "\1qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,inf,0,0\n");
  put("options", "number", "1e-3");
  put("options", "whole", "17");
  put("options", "name", "left_2");
  put("options", "interface", "fe80::1%eth0.7");
  put("numbers", "poses",
      "\1qw,qx,qy,qz,tx,ty,tz,more\n1,0,0,0,0.1,0.2,0.3,x\n0.5,0.5,0.5,0.5,-1e-3,0,0,\n");
  hand::HandFile hand;
  hand.motion.path = {Vec3(0.0, 0.0, 0.1), Vec3(0.1, 0.0, 0.05)};
  hand.motion.repeat_from = 0;
  hand.posture_rad = {0.1, 0.2};
  put("numbers", "hand", "\2" + hand::to_text(hand));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2)
    return std::fputs("usage: make_corpus FOLDER\n", stderr), 2;
  g_root = argv[1];
  meshes(), scenes(VOXTOUCH_DEPLOY), ring(), changes(), plans(), packets(), bags(), numbers();
  return 0;
}

// Scene files: text to a scene that holds nothing but finite numbers within their ranges, or a
// sentence with its place.
#include <algorithm>

#include "core/scene/scene_file.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

bool unit(const Quat& q) { return std::abs(q.norm() - 1.0) < 1e-9; }
bool usable(const Pose& pose) { return pose.finite() && unit(pose.orientation); }
bool positive(double x) { return std::isfinite(x) && x > 0.0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0.0; }

void check(const scene::MeshSpec& mesh) {
  FUZZ_REQUIRE(positive(mesh.scale) && usable(mesh.pose) && mesh.path.is_absolute());
  for (const scene::Primitive& part : mesh.primitives) {
    if (const auto* sphere = std::get_if<scene::SpherePrimitive>(&part))
      FUZZ_REQUIRE(sphere->centre.allFinite() && positive(sphere->radius_m));
    if (const auto* box = std::get_if<scene::BoxPrimitive>(&part))
      FUZZ_REQUIRE(usable(box->pose) && box->size_m.allFinite() && box->size_m.minCoeff() > 0.0);
    if (const auto* cylinder = std::get_if<scene::CylinderPrimitive>(&part))
      FUZZ_REQUIRE(usable(cylinder->pose) && positive(cylinder->radius_m) &&
                   positive(cylinder->length_m));
  }
}

void check(const scene::ContactSpec& contact) {
  FUZZ_REQUIRE(not_negative(contact.stiffness_n_per_m) && not_negative(contact.stiffness_n_per_m3));
  FUZZ_REQUIRE((contact.stiffness_n_per_m > 0.0) != (contact.stiffness_n_per_m3 > 0.0));
}

void check(const Motion& motion) {
  FUZZ_REQUIRE(!motion.path.empty() && positive(motion.speed_m_per_s) &&
               not_negative(motion.hold_s));
  FUZZ_REQUIRE(unit(motion.orientation));
  for (const Vec3& point : motion.path)
    FUZZ_REQUIRE(point.allFinite());
  if (motion.repeat_from)
    FUZZ_REQUIRE(*motion.repeat_from + 1 < motion.path.size());
  // The hand's motion must be finite at any time.
  for (const double time_s : {0.0, 1e-3, 1.0, 1e3, 1e15, 1e300}) {
    const MotionPoint point = motion_at(motion, time_s);
    FUZZ_REQUIRE(point.position.allFinite() && point.velocity.allFinite());
    (void)buttons_at(motion, time_s);
  }
}

void check(const effects::EffectSpec& effect) {
  FUZZ_REQUIRE(effect.kind != nullptr && !effect.name.empty());
  FUZZ_REQUIRE(effect.gain >= 0.0 && effect.gain <= 1.0);
  FUZZ_REQUIRE(effects::check_values(*effect.kind, effect.values).empty());
  const effects::EffectBound bound = effects::bound_of(effect);
  FUZZ_REQUIRE(bound.stiffness_n_per_m >= 0.0 && bound.stiffness_nm_per_rad >= 0.0);
  FUZZ_REQUIRE(bound.damping_ns_per_m >= 0.0 && bound.damping_nms_per_rad >= 0.0);
}

void check(const scene::Scene& scene) {
  FUZZ_REQUIRE(!scene.name.empty() && scene.hash.size() == 16 && positive(scene.voxel_size_m));
  FUZZ_REQUIRE(!scene.static_meshes.empty());
  for (const scene::MeshSpec& mesh : scene.static_meshes) {
    check(mesh);
    FUZZ_REQUIRE(mesh.object <= scene.objects.size());
  }
  check(scene.dynamic_mesh);
  check(scene.contact);
  for (const scene::ObjectSpec& object : scene.objects) {
    check(object.contact);
    if (object.moves)
      check(*object.moves);
  }
  if (scene.grid_origin)
    FUZZ_REQUIRE(scene.grid_origin->allFinite());
  for (const effects::EffectSpec& effect : scene.effects)
    check(effect);
  for (const auto& [name, motion] : scene.motions)
    check(motion);
  for (const coupling::CouplingIssue& issue :
       coupling::validate(scene.coupling, {}, scene::kSceneSampleTimeS))
    FUZZ_REQUIRE(!issue.refuse);
  FUZZ_REQUIRE(positive(scene.device.position_scale) && positive(scene.device.force_scale));
  FUZZ_REQUIRE(usable(scene.device.pose_WD) && usable(scene.device.pose_PT));
  if (scene.device.clutch_button)
    FUZZ_REQUIRE(*scene.device.clutch_button < 32);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  static const std::filesystem::path file = std::string(VOXTOUCH_DEPLOY) + "/scenes/fuzz.yaml";
  try {
    const scene::Scene scene = scene::parse_scene(text, file);
    check(scene);
    FUZZ_REQUIRE(scene::parse_scene(text, file).hash == scene.hash);
  } catch (const scene::SceneError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with(file.string()));
  }
  return 0;
}

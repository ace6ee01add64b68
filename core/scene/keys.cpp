// Scene files, but for motions (motion_keys.cpp).
#include "core/coupling/velocity_window.hpp"
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene {

std::vector<std::string_view> words_of(std::string_view list) {
  std::vector<std::string_view> words;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(' '), list.size());
    words.push_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return words;
}

namespace keys {
namespace {

// A row a key: name, kind, rule, standard, meaning; then words, group and limits, if any.
constexpr auto kPose =
    std::to_array<Key>({{"position", kVector, kOptional, initial<&Pose::position>, "Position [m]."},
                        {"orientation", kQuaternion, kOptional, initial<&Pose::orientation>}});

constexpr auto kSphere =
    std::to_array<Key>({{"centre", kVector, kOptional, initial<&SpherePrimitive::centre>, "[m]"},
                        {"radius", kPositive, kRequired, kNone, "[m]"}});
// A region has no default centre, unlike a part of a mesh.
constexpr auto kRegionSphere = std::to_array<Key>(
    {{"centre", kVector, kRequired, kNone, "[m]"}, {"radius", kPositive, kRequired, kNone, "[m]"}});
constexpr auto kBox = joined(
    kPose, std::to_array<Key>(
               {{"size", kSize, kRequired, kNone, "Edge lengths along the box's axes [m]."}}));
constexpr auto kCylinder =
    joined(kPose, std::to_array<Key>({{"radius", kPositive, kRequired, kNone, "[m]"},
                                      {"length", kPositive, kRequired, kNone,
                                       "Length along the cylinder's z axis [m]."}}));
constexpr auto kPart = std::to_array<Key>({{"sphere", kMap, kOneOf, kNone, "", "", &sphere},
                                           {"box", kMap, kOneOf, kNone, "", "", &box},
                                           {"cylinder", kMap, kOneOf, kNone, "", "", &cylinder}});

constexpr auto kMesh = joined(
    joined(std::to_array<Key>(
               {{"mesh", kText, kRequired, kNone,
                 "OBJ, STL, PLY, glTF/GLB or COLLADA; paths start at the scene file's folder."},
                {"scale", kPositive, kOptional, initial<&MeshSpec::scale>,
                 "Metres per unit of the file."}}),
           kPose),
    std::to_array<Key>(
        {{"parts", kMaps, kOptional, kNone,
          "Closed forms of the mesh for the validator, in the frame of the scaled mesh.", "",
          &part}}));
constexpr auto kStaticMesh = joined(
    kMesh, std::to_array<Key>(
               {{"origin", kVector, kOptional, kNone,
                 "Origin of the object's voxel grid [m], on at most one of its meshes. Default: "
                 "faces along the grid lie far from voxel borders. For borders at multiples of the "
                 "voxel edge e use e (floor(min / e) - 1) on each axis, with the smallest "
                 "coordinate min of the object's meshes; `voxtouch plan` prints both."},
                {"object", kMap, kOptional, kNone, "", "", &object}}));
constexpr auto kObject =
    std::to_array<Key>({{"name", kName, kRequired, kNone, "Name of the object."},
                        {"stiffness_n_per_m", kPositive, kNotTogether, kNone,
                         "Stiffness per shell point against it [N/m]. Default: the scene's."},
                        {"stiffness_n_per_m3", kPositive, kNotTogether, kNone,
                         "Stiffness per area against it [N/m^3]. Default: the scene's."},
                        {"moves", kMap, kOptional, kNone, "", "", &object_motion}});
constexpr auto kDynamicMesh = joined(
    kMesh, std::to_array<Key>({{"shell", kWord, kOptional, initial<&Scene::shell>,
                                "Shell points on the surface (exact) or at voxel centres (naive).",
                                "exact naive"}}));

constexpr auto kContact = std::to_array<Key>(
    {{"model", kWord, kOptional, initial<&ContactSpec::model>,
      "Contact model, from fastest to most accurate; see `voxtouch accuracy`.",
      "original adapted field"},
     {"rendering", kWord, kOptional, kNone,
      "How a depth becomes a force. virtual_tool: a second tool stays outside the scene and "
      "displays the coupling's certified stiffness; its model is `field`, and no stiffness is "
      "given. penalty: the force grows with depth. memoryless: penalty as in the paper, where a "
      "point that has crossed a wall gives no force. Default: virtual_tool for `field` without a "
      "stiffness, otherwise penalty. With the effect `body` and no stiffness: penalty, with the "
      "stiffness derived from the body's mass.",
      "virtual_tool penalty memoryless"},
     {"stiffness_n_per_m", kPositive, kOneOf, kNone,
      "Stiffness per shell point [N/m], for original and adapted."},
     {"stiffness_n_per_m3", kPositive, kOneOf, kNone,
      "Stiffness per area of the tool's surface [N/m^3], for any model."}});

constexpr auto kTool =
    std::to_array<Key>({{"lever_m", kPositive, kOptional, kNone,
                         "Length that weighs rotation against translation [m]. Default: the tool's "
                         "largest distance from its origin."}});

constexpr auto kRegion =
    std::to_array<Key>({{"sphere", kMap, kOneOf, kNone, "", "", &region_sphere},
                        {"box", kMap, kOneOf, kNone, "", "", &box},
                        {"blend_m", kPositive, kOptional, initial<&effects::Region::blend_m>,
                         "Length over which the effect fades out beyond the shape [m]."}});
constexpr auto kEffect = std::to_array<Key>(
    {{"name", kName, kOptional, kNone,
      "Name for changes while the ring runs. Default: the effect's kind."},
     {"region", kMap, kOptional, kNone, "", "", &region},
     {"object", kName, kOptional, kNone,
      "Object whose contact the effect uses. `ground`: meshes without an object."},
     {"gain", kNumber, kOptional, initial<&effects::EffectSpec::gain>,
      "Fraction of its force that is displayed.", "", nullptr, 0, 1},
     {"on", kFlag, kOptional, initial<&effects::EffectSpec::on>,
      "false: built, but switched off at the start."}});

constexpr auto kHand =
    std::to_array<Key>({{"mass_kg", kRange, kRequired, kNone, "[low, high]"},
                        {"damping_ns_per_m", kRange, kRequired, kNone, "[low, high]"},
                        {"stiffness_n_per_m", kRange, kRequired, kNone, "[low, high]"},
                        {"inertia_kg_m2", kRange, kAllOrNone, kNone, "[low, high]"},
                        {"damping_nms_per_rad", kRange, kAllOrNone, kNone, "[low, high]"},
                        {"stiffness_nm_per_rad", kRange, kAllOrNone, kNone, "[low, high]"}});
constexpr auto kCoupling = std::to_array<Key>(
    {{"design", kWord, kOptional, kNone, "Design the coupling for device, hand and contact.",
      "auto"},
     {"kind", kWord, kOptional, kNone,
      "Coupling law; `auto` needs `design`. Default without `design`: shaping_filter.",
      "auto shaping_filter spring_damper direct"},
     {"cutoff_hz", kPositive, kOptional, kNone,
      "Cut-off of the shaping filter, w0 / (2 pi) [Hz]. With `design`: its lower bound."},
     {"damping_ratio", kPositive, kWithoutFirst, initial<&coupling::CouplingSpec::damping_ratio>,
      "Damping ratio of the shaping filter [1]."},
     {"gain", kPositive, kWithoutFirst, initial<&coupling::CouplingSpec::gain>,
      "Gain of the shaping filter, force over force [1]."},
     {"stiffness_n_per_m", kPositive, kWithoutFirst,
      initial<&coupling::CouplingSpec::stiffness_n_per_m>, "Stiffness of the spring-damper [N/m]."},
     {"damping_ns_per_m", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::damping_ns_per_m>, "Damping of the spring-damper [Ns/m]."},
     {"stiffness_cap_n_per_m", kPositive, kOptional, kNone,
      "Upper limit of the displayed contact stiffness, in W [N/m]."},
     {"stiffness_cap_nm_per_rad", kPositive, kOptional, kNone,
      "Upper limit of the displayed rotational contact stiffness [Nm/rad]."},
     {"injected_damping_ns_per_m", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::injected_damping_ns_per_m>,
      "Damping injected during contact [Ns/m]."},
     {"injected_damping_nms_per_rad", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::injected_damping_nms_per_rad>,
      "Rotational damping injected during contact [Nms/rad]."},
     {"velocity_filter_hz", kPositive, kWithoutFirst,
      initial<&coupling::CouplingSpec::velocity_filter_hz>,
      "Cut-off of the velocity that injected damping uses [Hz]."},
     {"velocity_window", kCount, kWithoutFirst, initial<&coupling::CouplingSpec::velocity_window>,
      "n: damping uses the velocity over a window of 3 n samples. 0: it uses the filtered "
      "velocity.",
      "", nullptr, 0, coupling::kMaxVelocityWindow},
     {"slow_velocity_hz", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::slow_velocity_hz>,
      "Cut-off of the slow velocity estimate [Hz]; 0 disables it. It replaces the fast one while "
      "both differ only by encoder quantisation."},
     {"velocity_band_m_per_s", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::velocity_band_m_per_s>,
      "Largest difference that encoder quantisation explains, per axis in W [m/s]."},
     {"damping_force_ratio", kNotNegative, kOptional, kNone,
      "Bound of the injected damping force, relative to contact and effects [1]; 0: unbounded. A "
      "small constant force is added to the bound. Default: 0.35 if at least 2/3 of the unbounded "
      "stiffness remains, otherwise the smallest of 0.7, 2, 6 and 24 that keeps 9/10, otherwise 0. "
      "A given value that costs more than 1/3 of the stiffness is not used."},
     {"gain_margin", kNumber, kWithFirst, initial<&DesignOptions::gain_margin>,
      "Factor between the limit of stability and the worst case [1].", "", nullptr, 1},
     {"min_damping_ratio", kNumber, kWithFirst, initial<&DesignOptions::min_damping_ratio>,
      "Minimum damping ratio of the dominant mode in contact, with a hand [1]. With the device "
      "released a third of it is required. The designer reduces stiffness to reach it; 0: no "
      "requirement.",
      "", nullptr, 0, 0.9},
     {"rotation_min_damping_ratio", kNumber, kWithFirst,
      initial<&DesignOptions::rotation_min_damping_ratio>,
      "Minimum damping ratio of rotation [1]. Its damping is displayed as torque.", "", nullptr, 0,
      0.9},
     {"hand", kMap, kWithFirst, kNone, "Hand model: a name or ranges. Default: that of the device.",
      "pen arm any_passive", &hand},
     {"released", kFlag, kWithFirst, initial<&DesignOptions::released>,
      "The loop must also be stable with the device released."},
     {"inject_damping", kFlag, kWithFirst, initial<&DesignOptions::inject_damping>,
      "The designer may inject damping."},
     {"velocity_windows", kFlag, kWithFirst, initial<&DesignOptions::velocity_windows>,
      "The designer may choose `velocity_window`. It gives up to 1.6 times the stiffness at the "
      "same noise."},
     {"run_infeasible", kFlag, kWithFirst, initial<&DesignOptions::run_infeasible>,
      "Run the best coupling found even if no design is feasible."}});

constexpr auto kDevice = std::to_array<Key>(
    {{"position_scale", kPositive, kOptional, initial<&WorkspaceMapping::position_scale>,
      "Metres of the tool per metre of the device."},
     {"force_scale", kPositive, kOptional, initial<&WorkspaceMapping::force_scale>,
      "Newtons at the device per newton in the scene."},
     {"pose", kMap, kOptional, kNone, "Pose of the device's base in the scene.", "", &pose},
     {"tool", kMap, kOptional, kNone, "Pose of the tool in the frame of the device's tip.", "",
      &pose},
     {"clutch_button", kButton, kOptional, kNone,
      "While this button is pressed the tool stays and the device moves freely."}});

constexpr auto kScene = std::to_array<Key>(
    {{"scene", kName, kRequired, kNone, "The scene's name."},
     {"voxel_size", kPositive, kRequired, kNone, "Edge of a voxel [m]."},
     {"static", kMaps, kRequired, kNone, "Static meshes: what the tool can touch.", "",
      &static_mesh, 1},
     {"dynamic", kMap, kRequired, kNone, "", "", &dynamic_mesh},
     {"contact", kMap, kRequired, kNone, "", "", &contact},
     {"tool", kMap, kOptional, kNone, "", "", &tool},
     {"effects", kMaps, kOptional, kNone,
      "Forces added to the contact. An effect that is not listed is not computed.", "", &effect},
     {"coupling", kMap, kOptional, kNone, "", "", &coupling},
     {"device", kMap, kOptional, kNone, "", "", &device},
     {"motions", kNamedMaps, kOptional, kNone, "Motions of a simulated hand, by name.", "",
      &motion}});

}  // namespace

constinit const KeyGroup scene{"", "", kScene};
constinit const KeyGroup static_mesh{"static_mesh", "", kStaticMesh};
constinit const KeyGroup dynamic_mesh{"", "The mesh of the tool, which the hand moves.",
                                      kDynamicMesh};
constinit const KeyGroup object{"object", "Definition of an object.", kObject};
constinit const KeyGroup contact{"", "Contact model and its stiffness.", kContact};
constinit const KeyGroup tool{"", "Properties of the tool that the virtual tool uses.", kTool};
constinit const KeyGroup effect{"effect", "One effect.", kEffect};
constinit const KeyGroup coupling{"", "Coupling between contact and device.", kCoupling};
constinit const KeyGroup device{"", "Mapping from the device's motion to the tool's.", kDevice};
constinit const KeyGroup pose{"pose", "", kPose};
constinit const KeyGroup part{
    "part", "Closed form of the mesh, or of a convex part of it, for the validator.", kPart};
constinit const KeyGroup sphere{"", "", kSphere};
constinit const KeyGroup box{"", "", kBox};
constinit const KeyGroup cylinder{"", "", kCylinder};
constinit const KeyGroup region{"region", "The effect acts only inside this shape.", kRegion};
constinit const KeyGroup region_sphere{"", "", kRegionSphere};
constinit const KeyGroup hand{"", "Ranges of the hand's mass, damping and stiffness.", kHand};

}  // namespace keys
}  // namespace voxtouch::scene

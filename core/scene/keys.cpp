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
constexpr auto kPose = std::to_array<Key>(
    {{"position", kVector, kOptional, initial<&Pose::position>, "Where it is [m]."},
     {"orientation", kQuaternion, kOptional, initial<&Pose::orientation>}});

constexpr auto kSphere =
    std::to_array<Key>({{"centre", kVector, kOptional, initial<&SpherePrimitive::centre>, "[m]"},
                        {"radius", kPositive, kRequired, none, "[m]"}});
// A region has no place of its own to be centred at, where a part of a mesh has.
constexpr auto kRegionSphere = std::to_array<Key>(
    {{"centre", kVector, kRequired, none, "[m]"}, {"radius", kPositive, kRequired, none, "[m]"}});
constexpr auto kBox = joined(
    kPose,
    std::to_array<Key>({{"size", kSize, kRequired, none, "Edges along the box's own axes [m]."}}));
constexpr auto kCylinder =
    joined(kPose, std::to_array<Key>(
                      {{"radius", kPositive, kRequired, none, "[m]"},
                       {"length", kPositive, kRequired, none, "Along the cylinder's own z [m]."}}));
constexpr auto kPart = std::to_array<Key>({{"sphere", kMap, kOneOf, none, "", "", &sphere},
                                           {"box", kMap, kOneOf, none, "", "", &box},
                                           {"cylinder", kMap, kOneOf, none, "", "", &cylinder}});

constexpr auto kMesh = joined(
    joined(std::to_array<Key>(
               {{"mesh", kText, kRequired, none,
                 "OBJ, STL, PLY, glTF/GLB or COLLADA; paths start at the scene file's folder."},
                {"scale", kPositive, kOptional, initial<&MeshSpec::scale>,
                 "Metres for one unit of the file."}}),
           kPose),
    std::to_array<Key>(
        {{"parts", kMaps, kOptional, none,
          "Closed forms that stand for the mesh in the validator, in its frame after scaling.", "",
          &part}}));
constexpr auto kStaticMesh = joined(
    kMesh,
    std::to_array<Key>({{"origin", kVector, kOptional, none,
                         "Where the voxel grid of the object begins, or of the ground [m]; on one "
                         "of its meshes at most. Left out: so that faces along the grid lie far "
                         "from voxel borders. For the grid with borders at multiples of the voxel "
                         "e, standard before: e (floor(min / e) - 1) for each axis, min the "
                         "least coordinate of its meshes; `voxtouch plan` says both."},
                        {"object", kMap, kOptional, none, "", "", &object}}));
constexpr auto kObject =
    std::to_array<Key>({{"name", kName, kRequired, none, "Of the object."},
                        {"stiffness_n_per_m", kPositive, kNotTogether, none,
                         "Of each shell point against it [N/m]; left out: the scene's."},
                        {"stiffness_n_per_m3", kPositive, kNotTogether, none,
                         "Per area against it [N/m^3]; left out: the scene's."},
                        {"moves", kMap, kOptional, none, "", "", &object_motion}});
constexpr auto kDynamicMesh =
    joined(kMesh, std::to_array<Key>({{"shell", kWord, kOptional, initial<&Scene::shell>,
                                       "Shell points on the surface, or in the voxels' centres.",
                                       "exact naive"}}));

constexpr auto kContact = std::to_array<Key>(
    {{"model", kWord, kOptional, initial<&ContactSpec::model>,
      "Contact model, from the fastest to the most accurate: see `voxtouch accuracy`.",
      "original adapted field"},
     {"rendering", kWord, kOptional, none,
      "A virtual tool that stays outside what it touches, with `field` (then the standard model): "
      "it displays the coupling's certified stiffness, and none is given here. "
      "Or penalty, forces that grow with the depth. Or memoryless, these as the paper has them, "
      "to compare with it: points that have gone through a wall's "
      "voxels push no more, so it is soon passed. Left out: virtual_tool for `field` without a "
      "stiffness, else penalty. With the effect `body` and no stiffness: penalty, and the "
      "stiffness follows from the body's mass.",
      "virtual_tool penalty memoryless"},
     {"stiffness_n_per_m", kPositive, kOneOf, none,
      "Of each shell point [N/m]; original and adapted."},
     {"stiffness_n_per_m3", kPositive, kOneOf, none,
      "Per area of the tool's surface [N/m^3]; any model."}});

constexpr auto kTool =
    std::to_array<Key>({{"lever_m", kPositive, kOptional, none,
                         "Lever by which a virtual tool weighs turns against shifts [m]; left out: "
                         "as far as the tool reaches from its origin."}});

constexpr auto kRegion =
    std::to_array<Key>({{"sphere", kMap, kOneOf, none, "", "", &region_sphere},
                        {"box", kMap, kOneOf, none, "", "", &box},
                        {"blend_m", kPositive, kOptional, initial<&effects::Region::blend_m>,
                         "The effect fades out over this length beyond the shape [m]."}});
constexpr auto kEffect = std::to_array<Key>(
    {{"name", kName, kOptional, none,
      "Of this one, for the change while running; the kind's where it is left out."},
     {"region", kMap, kOptional, none, "", "", &region},
     {"object", kName, kOptional, none,
      "Feels the contact with this object alone; `ground` for the meshes of none."},
     {"gain", kNumber, kOptional, initial<&effects::EffectSpec::gain>,
      "Fraction of its force that is displayed.", "", nullptr, 0, 1},
     {"on", kFlag, kOptional, initial<&effects::EffectSpec::on>,
      "false: built and ready, switched off at the start."}});

constexpr auto kHand =
    std::to_array<Key>({{"mass_kg", kRange, kRequired, none, "[low, high]"},
                        {"damping_ns_per_m", kRange, kRequired, none, "[low, high]"},
                        {"stiffness_n_per_m", kRange, kRequired, none, "[low, high]"},
                        {"inertia_kg_m2", kRange, kAllOrNone, none, "[low, high]"},
                        {"damping_nms_per_rad", kRange, kAllOrNone, none, "[low, high]"},
                        {"stiffness_nm_per_rad", kRange, kAllOrNone, none, "[low, high]"}});
constexpr auto kCoupling = std::to_array<Key>(
    {{"design", kWord, kOptional, none, "The coupling is designed for device, hand and contact.",
      "auto"},
     {"kind", kWord, kOptional, none,
      "Law; `auto` goes with design. Else the standard is shaping_filter.",
      "auto shaping_filter spring_damper direct"},
     {"cutoff_hz", kPositive, kOptional, none,
      "Of the shaping filter, w0/(2 pi); with design a lower bound, which the designer may raise."},
     {"damping_ratio", kPositive, kWithoutFirst, initial<&coupling::CouplingSpec::damping_ratio>,
      "Of the shaping filter."},
     {"gain", kPositive, kWithoutFirst, initial<&coupling::CouplingSpec::gain>,
      "Of the shaping filter, force over force."},
     {"stiffness_n_per_m", kPositive, kWithoutFirst,
      initial<&coupling::CouplingSpec::stiffness_n_per_m>, "Of the spring-damper [N/m]."},
     {"damping_ns_per_m", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::damping_ns_per_m>, "Of the spring-damper [Ns/m]."},
     {"stiffness_cap_n_per_m", kPositive, kOptional, none,
      "The contact shows no more than this, in W [N/m]."},
     {"stiffness_cap_nm_per_rad", kPositive, kOptional, none,
      "The contact shows no more than this against rotation [Nm/rad]."},
     {"injected_damping_ns_per_m", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::injected_damping_ns_per_m>, "While in contact [Ns/m]."},
     {"injected_damping_nms_per_rad", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::injected_damping_nms_per_rad>,
      "While in contact [Nms/rad]."},
     {"velocity_filter_hz", kPositive, kWithoutFirst,
      initial<&coupling::CouplingSpec::velocity_filter_hz>, "Of the velocity that is damped."},
     {"velocity_window", kCount, kWithoutFirst, initial<&coupling::CouplingSpec::velocity_window>,
      "n, up to 5: damping acts on the velocity of a window of 3 n samples instead; 0: on the "
      "filter's.",
      "", nullptr, 0, coupling::kMaxVelocityWindow},
     {"slow_velocity_hz", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::slow_velocity_hz>,
      "Of a slower velocity, which is damped where the encoder's steps may be all that the other "
      "differs from it by; 0: none."},
     {"velocity_band_m_per_s", kNotNegative, kWithoutFirst,
      initial<&coupling::CouplingSpec::velocity_band_m_per_s>,
      "How much that may be along each axis, in W [m/s]."},
     {"damping_force_ratio", kNotNegative, kOptional, none,
      "Most that injected damping adds to what contact and effects give, as a ratio of it, plus a "
      "small constant force: so a touch begins with the contact. 0: without that bound. Left out: "
      "0.35, with design as long as it leaves two thirds of the stiffness, else the least of 0.7, "
      "2, 6 and 24 that leaves nine tenths, else 0. One that is given and would take more than a "
      "third is not kept."},
     {"gain_margin", kNumber, kWithFirst, initial<&DesignOptions::gain_margin>,
      "How much stiffer the worst case may get before it is unstable.", "", nullptr, 1},
     {"damping_floor", kNumber, kWithFirst, initial<&DesignOptions::damping_floor>,
      "Least damping ratio of the slowest swing along in contact, with a hand; a third of it with "
      "the device released. Stiffness is given up for it; 0: it is not.",
      "", nullptr, 0, 0.9},
     {"rotation_damping_floor", kNumber, kWithFirst,
      initial<&DesignOptions::rotation_damping_floor>,
      "The same of rotation: the damping that it needs is displayed in torques.", "", nullptr, 0,
      0.9},
     {"hand", kMap, kWithFirst, none, "Who may hold the device; left out: as the device is held.",
      "pen arm any_passive", &hand},
     {"released", kFlag, kWithFirst, initial<&DesignOptions::released>,
      "Must be stable when released too."},
     {"inject_damping", kFlag, kWithFirst, initial<&DesignOptions::inject_damping>,
      "The designer may inject damping."},
     {"velocity_windows", kFlag, kWithFirst, initial<&DesignOptions::velocity_windows>,
      "Injected damping may act on the velocity of a window of samples too: up to 1.6 times the "
      "stiffness for the same noise."},
     {"run_infeasible", kFlag, kWithFirst, initial<&DesignOptions::run_infeasible>,
      "Run what was found even where the design says that it will not do."}});

constexpr auto kDevice = std::to_array<Key>(
    {{"position_scale", kPositive, kOptional, initial<&WorkspaceMapping::position_scale>,
      "Metres of the tool for one metre of the device."},
     {"force_scale", kPositive, kOptional, initial<&WorkspaceMapping::force_scale>,
      "Newtons at the device for one newton of the scene."},
     {"pose", kMap, kOptional, none, "The device's base in the scene.", "", &pose},
     {"tool", kMap, kOptional, none, "The tool in the frame of the device's tip.", "", &pose},
     {"clutch_button", kButton, kOptional, none,
      "While this button is pressed the tool stays and the device moves free."}});

constexpr auto kScene = std::to_array<Key>(
    {{"scene", kName, kRequired, none, "The scene's name."},
     {"voxel_size", kPositive, kRequired, none, "Edge of a voxel [m]."},
     {"static", kMaps, kRequired, none, "What can be touched.", "", &static_mesh, 1},
     {"dynamic", kMap, kRequired, none, "", "", &dynamic_mesh},
     {"contact", kMap, kRequired, none, "", "", &contact},
     {"tool", kMap, kOptional, none, "", "", &tool},
     {"effects", kMaps, kOptional, none,
      "Forces added to the contact; what is not here is not computed.", "", &effect},
     {"coupling", kMap, kOptional, none, "", "", &coupling},
     {"device", kMap, kOptional, none, "", "", &device},
     {"motions", kNamedMaps, kOptional, none, "What simulated hands can do, by name.", "",
      &motion}});

}  // namespace

constinit const KeyGroup scene{"", "", kScene};
constinit const KeyGroup static_mesh{"static_mesh", "", kStaticMesh};
constinit const KeyGroup dynamic_mesh{"", "The tool: what the hand moves.", kDynamicMesh};
constinit const KeyGroup object{"object", "Made here.", kObject};
constinit const KeyGroup contact{"", "How the tool is pushed out of what it touches.", kContact};
constinit const KeyGroup tool{"", "What a virtual tool must know of the tool.", kTool};
constinit const KeyGroup effect{"effect", "One effect.", kEffect};
constinit const KeyGroup coupling{"", "Between contact and device.", kCoupling};
constinit const KeyGroup device{"", "How the device moves the tool.", kDevice};
constinit const KeyGroup pose{"pose", "", kPose};
constinit const KeyGroup part{
    "part", "A closed form that stands for the mesh, or a convex part of it, in the validator.",
    kPart};
constinit const KeyGroup sphere{"", "", kSphere};
constinit const KeyGroup box{"", "", kBox};
constinit const KeyGroup cylinder{"", "", kCylinder};
constinit const KeyGroup region{"region", "The effect works in here only.", kRegion};
constinit const KeyGroup region_sphere{"", "", kRegionSphere};
constinit const KeyGroup hand{"", "Ranges of a hand.", kHand};

}  // namespace keys
}  // namespace voxtouch::scene

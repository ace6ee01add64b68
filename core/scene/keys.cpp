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

// clang-format off: one row a key: name, kind, rule, standard, meaning; then words, group and limits where there are some.
constexpr auto kPose =
    std::to_array<Key>({{"position", kVector, kOptional, "[0, 0, 0]", "Where it is [m]."},
                        {"orientation", kQuaternion, kOptional, "[1, 0, 0, 0]"}});

constexpr auto kSphere = std::to_array<Key>({{"centre", kVector, kOptional, "[0, 0, 0]", "[m]"},
                                             {"radius", kPositive, kRequired, "", "[m]"}});
// A region has no place of its own to be centred at, where a part of a mesh has.
constexpr auto kRegionSphere = std::to_array<Key>(
    {{"centre", kVector, kRequired, "", "[m]"}, {"radius", kPositive, kRequired, "", "[m]"}});
constexpr auto kBox = joined(
    kPose,
    std::to_array<Key>({{"size", kSize, kRequired, "", "Edges along the box's own axes [m]."}}));
constexpr auto kCylinder = joined(
    kPose,
    std::to_array<Key>({{"radius", kPositive, kRequired, "", "[m]"},
                        {"length", kPositive, kRequired, "", "Along the cylinder's own z [m]."}}));
constexpr auto kPart = std::to_array<Key>({{"sphere", kMap, kOneOf, "", "", "", &sphere},
                                           {"box", kMap, kOneOf, "", "", "", &box},
                                           {"cylinder", kMap, kOneOf, "", "", "", &cylinder}});

constexpr auto kMesh = joined(
    joined(std::to_array<Key>(
               {{"mesh", kText, kRequired, "",
                 "OBJ, STL, PLY, glTF/GLB or COLLADA; paths start at the scene file's folder."},
                {"scale", kPositive, kOptional, "1", "Metres for one unit of the file."}}),
           kPose),
    std::to_array<Key>(
        {{"parts", kMaps, kOptional, "",
          "Closed forms that stand for the mesh in the validator, in its frame after scaling.", "",
          &part}}));
constexpr auto kStaticMesh = joined(
    kMesh,
    std::to_array<Key>({{"origin", kVector, kOptional, "",
                         "Where the voxel grid of the object begins, or of the ground [m]; on one "
                         "of its meshes at most. Left out: so that faces along the grid lie far "
                         "from voxel borders. For the grid with borders at multiples of the voxel "
                         "e, standard before: e (floor(min / e) - 1) for each axis, min the "
                         "least coordinate of its meshes; `voxtouch plan` says both."},
                        {"object", kMap, kOptional, "", "", "", &object}}));
constexpr auto kObject =
    std::to_array<Key>({{"name", kName, kRequired, "", "Of the object."},
                        {"stiffness_n_per_m", kPositive, kNotTogether, "",
                         "Of each shell point against it [N/m]; left out: the scene's."},
                        {"stiffness_n_per_m3", kPositive, kNotTogether, "",
                         "Per area against it [N/m^3]; left out: the scene's."},
                        {"moves", kMap, kOptional, "", "", "", &way}});
constexpr auto kDynamicMesh =
    joined(kMesh, std::to_array<Key>({{"shell", kWord, kOptional, "exact",
                                       "Shell points on the surface, or in the voxels' centres.",
                                       "exact naive"}}));

constexpr auto kContact = std::to_array<Key>(
    {{"model", kWord, kOptional, "adapted",
      "Contact model, from the fastest to the most accurate: see `voxtouch accuracy`.",
      "original adapted field"},
     {"rendering", kWord, kOptional, "",
      "A virtual tool that stays outside what it touches, with `field` (then the standard model): "
      "the coupling's certified stiffness is felt, and none is given here. "
      "Or penalty, forces that grow with the depth. Or model_alone, these as the paper has them, "
      "to compare with it: points that have gone through a wall's "
      "voxels push no more, so it is soon passed. Left out: virtual_tool for `field` without a "
      "stiffness, else penalty.",
      "virtual_tool penalty model_alone"},
     {"stiffness_n_per_m", kPositive, kOneOf, "",
      "Of each shell point [N/m]; original and adapted."},
     {"stiffness_n_per_m3", kPositive, kOneOf, "",
      "Per area of the tool's surface [N/m^3]; any model."}});

constexpr auto kTool =
    std::to_array<Key>({{"lever_m", kPositive, kOptional, "",
                         "Lever by which a virtual tool weighs turns against shifts [m]; left out: "
                         "as far as the tool reaches from its origin."}});

constexpr auto kRegion =
    std::to_array<Key>({{"sphere", kMap, kOneOf, "", "", "", &region_sphere},
                        {"box", kMap, kOneOf, "", "", "", &box},
                        {"blend_m", kPositive, kOptional, "0.002",
                         "The effect fades out over this length beyond the shape [m]."}});
constexpr auto kEffect = std::to_array<Key>(
    {{"name", kName, kOptional, "",
      "Of this one, for the change while running; the kind's where it is left out."},
     {"region", kMap, kOptional, "", "", "", &region},
     {"object", kName, kOptional, "",
      "Feels the contact with this object alone; `ground` for the meshes of none."},
     {"gain", kNumber, kOptional, "1", "Share of it that is felt.", "", nullptr, 0, 1},
     {"on", kFlag, kOptional, "true", "false: built and ready, switched off at the start."}});

constexpr auto kHand =
    std::to_array<Key>({{"mass_kg", kRange, kRequired, "", "[low, high]"},
                        {"damping_ns_per_m", kRange, kRequired, "", "[low, high]"},
                        {"stiffness_n_per_m", kRange, kRequired, "", "[low, high]"},
                        {"inertia_kg_m2", kRange, kAllOrNone, "", "[low, high]"},
                        {"damping_nms_per_rad", kRange, kAllOrNone, "", "[low, high]"},
                        {"stiffness_nm_per_rad", kRange, kAllOrNone, "", "[low, high]"}});
constexpr auto kCoupling = std::to_array<Key>(
    {{"design", kWord, kOptional, "", "The coupling is designed for device, hand and contact.",
      "auto"},
     {"kind", kWord, kOptional, "",
      "Law; `auto` goes with design. Else the standard is shaping_filter.",
      "auto shaping_filter spring_damper direct"},
     {"cutoff_hz", kPositive, kOptional, "",
      "Of the shaping filter, w0/(2 pi); with design a wish, which the designer may raise."},
     {"damping_ratio", kPositive, kWithoutFirst, "0.7071067811865476", "Of the shaping filter."},
     {"gain", kPositive, kWithoutFirst, "1", "Of the shaping filter, force over force."},
     {"stiffness_n_per_m", kPositive, kWithoutFirst, "500", "Of the spring-damper [N/m]."},
     {"damping_ns_per_m", kNotNegative, kWithoutFirst, "2", "Of the spring-damper [Ns/m]."},
     {"stiffness_cap_n_per_m", kPositive, kOptional, "",
      "The contact shows no more than this, in W [N/m]."},
     {"stiffness_cap_nm_per_rad", kPositive, kOptional, "",
      "The contact shows no more than this against rotation [Nm/rad]."},
     {"injected_damping_ns_per_m", kNotNegative, kWithoutFirst, "0", "While in contact [Ns/m]."},
     {"injected_damping_nms_per_rad", kNotNegative, kWithoutFirst, "0",
      "While in contact [Nms/rad]."},
     {"velocity_filter_hz", kPositive, kWithoutFirst, "100", "Of the velocity that is damped."},
     {"velocity_window", kCount, kWithoutFirst, "0",
      "n, up to 5: damping acts on the velocity of a window of 3 n samples instead; 0: on the "
      "filter's.",
      "", nullptr, 0, coupling::kMaxVelocityWindow},
     {"slow_velocity_hz", kNotNegative, kWithoutFirst, "0",
      "Of a slower velocity, which is damped where the encoder's steps may be all that the other "
      "differs from it by; 0: none."},
     {"velocity_band_m_per_s", kNotNegative, kWithoutFirst, "0",
      "How much that may be along each axis, in W [m/s]."},
     {"damper_share", kNotNegative, kOptional, "",
      "Most that injected damping adds to what contact and effects give, as a share of it, besides "
      "a little that is hardly felt: so a touch begins with the contact. 0: without that bound. "
      "Left out: 0.35, with design as long as it leaves two thirds of the stiffness, else the "
      "least of 0.7, 2, 6 and 24 that leaves nine tenths, else 0. One that is given and would take "
      "more than a third is not kept."},
     {"gain_margin", kNumber, kWithFirst, "2",
      "How much stiffer the worst case may get before it is unstable.", "", nullptr, 1},
     {"damping_floor", kNumber, kWithFirst, "0.3",
      "Least damping ratio of the slowest swing along in contact, with a hand; a third of it with "
      "nobody holding the device. Stiffness is given up for it; 0: it is not.",
      "", nullptr, 0, 0.9},
     {"rotation_damping_floor", kNumber, kWithFirst, "0",
      "The same of turning: the damping that it asks for is felt in torques.", "", nullptr, 0, 0.9},
     {"hand", kMap, kWithFirst, "", "Who may hold the device; left out: as the device is held.",
      "pen arm any_passive", &hand},
     {"released", kFlag, kWithFirst, "true", "Must be stable with nobody holding it too."},
     {"inject_damping", kFlag, kWithFirst, "true", "The designer may inject damping."},
     {"velocity_windows", kFlag, kWithFirst, "true",
      "Injected damping may act on the velocity of a window of samples too: up to 1.6 times the "
      "stiffness for the same noise."},
     {"run_infeasible", kFlag, kWithFirst, "false",
      "Run what was found even where the design says that it will not do."}});

constexpr auto kDevice = std::to_array<Key>(
    {{"position_scale", kPositive, kOptional, "1",
      "Metres of the tool for one metre of the device."},
     {"force_scale", kPositive, kOptional, "1",
      "Newtons at the device for one newton of the scene."},
     {"pose", kMap, kOptional, "", "The device's base in the scene.", "", &pose},
     {"tool", kMap, kOptional, "", "The tool in the frame of the device's tip.", "", &pose},
     {"clutch_button", kButton, kOptional, "",
      "While this button is pressed the tool stays and the device moves free."}});

constexpr auto kScene = std::to_array<Key>(
    {{"scene", kName, kRequired, "", "The scene's name."},
     {"voxel_size", kPositive, kRequired, "", "Edge of a voxel [m]."},
     {"static", kMaps, kRequired, "", "What can be touched.", "", &static_mesh, 1},
     {"dynamic", kMap, kRequired, "", "", "", &dynamic_mesh},
     {"contact", kMap, kRequired, "", "", "", &contact},
     {"tool", kMap, kOptional, "", "", "", &tool},
     {"budget_us", kPositive, kOptional, "",
      "Time that a frame of the rendering may take [us], turned into a count of points when the "
      "scene is built: where more would have to be tested, "
      "coarser levels of the shell are. A virtual tool leaves out none; it makes fewer queries. "
      "Left out: every point counts."},
     {"effects", kMaps, kOptional, "",
      "What is felt beside the contact; what is not here is not computed.", "", &effect},
     {"coupling", kMap, kOptional, "", "", "", &coupling},
     {"device", kMap, kOptional, "", "", "", &device},
     {"motions", kNamedMaps, kOptional, "", "What simulated hands can do, by name.", "", &motion}});
// clang-format on

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

#include "nodes/cli/help.hpp"

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

namespace voxtouch::cli {
namespace {

struct VerbHelp {
  const char* summary;  ///< one line, for the list of verbs
  const char* details;  ///< below the options: further facts, then examples
};

const std::map<std::string, VerbHelp, std::less<>> kVerbs = {
    {"up",
     {"Start a ring: device, rendering, coupling, logger, validator",
      "The ring runs until Ctrl-C or --duration. Then a summary is printed. Exit status 0 if the "
      "run passed\n"
      "its limits, else 1.\n"
      "\n"
      "Examples:\n"
      "  voxtouch up cup_virtual_tool --motion slide --view\n"
      "  voxtouch up cup_virtual_tool --hand-from page\n"
      "  voxtouch up part.yaml --device sim-lwr --motion press --duration 10\n"
      "  voxtouch up cup --lockstep --duration 5 --record golden"}},
    {"try",
     {"Touch a scene or a mesh with mouse, touch, keys or gamepad",
      "Starts `voxtouch up SCENE --hand-from page`, without a recording unless --record is given, "
      "and opens the\n"
      "page in the browser, if available. For a mesh, a scene is made first, as by `voxtouch "
      "new`.\n"
      "\n"
      "Examples:\n"
      "  voxtouch try\n"
      "  voxtouch try part.stl --device sim-lwr\n"
      "  voxtouch try cup_viscosity --record touched"}},
    {"new",
     {"Write a scene file for a mesh",
      "Measures the part and proposes unit, voxel size, tool and two motions of a simulated hand. "
      "The output\n"
      "gives the reason of each. Every line of the file may be changed afterwards.\n"
      "Without TOOL, the tool is a sphere, PART.tool.obj next to the scene. Scene, part and tool\n"
      "can be moved together.\n"
      "\n"
      "Examples:\n"
      "  voxtouch new part.stl\n"
      "  voxtouch new gear.stl peg.stl --unit mm --tool-unit mm --device sim:touch\n"
      "  voxtouch up part.yaml --motion press --view"}},
    {"build",
     {"Write the voxels and the pointshell of a mesh as files",
      "Writes <mesh>_surface.csv, <mesh>_interior.csv and <mesh>_shell.ply (points with normals "
      "and areas, for\n"
      "MeshLab or CloudCompare).\n"
      "\n"
      "Example:\n"
      "  voxtouch build part.stl --voxel 0.001 --scale 0.001 --out part_voxels"}},
    {"probe",
     {"Print the contact wrench for each pose of a CSV file",
      "One row per pose: nS,nI,coh,fx,fy,fz,tx,ty,tz (world axes, torque about the tool's origin). "
      "Poses are\n"
      "independent of each other. --model reference prints gap and direction instead, and the true "
      "wrench\n"
      "for a stiffness of 1 N/m^3. --spring follows the poses with a virtual tool instead.\n"
      "\n"
      "Examples:\n"
      "  voxtouch probe cup --poses poses.csv --model field --time\n"
      "  voxtouch probe cup_virtual_tool --poses path.csv --spring 500"}},
    {"design",
     {"Design the virtual coupling for a device and a scene",
      "All figures are at the hand. Exit status 1 if no coupling holds.\n"
      "\n"
      "Examples:\n"
      "  voxtouch design --device sim:touch\n"
      "  voxtouch design --device mine.yaml --scene cup --plot region.png"}},
    {"identify",
     {"Measure mass, friction, delay and encoder step of a device",
      "The device moves by itself, at most --box from its start, for 20 s an axis. Ctrl-C ends "
      "with zero\n"
      "force. Exit status 1 if an axis is not measured. Steps: deploy/doc/howto/identify.md\n"
      "\n"
      "The force scale without a payload, other poses and rotation stay unknown. `up "
      "--device-file` "
      "uses the\n"
      "file; its check at start sees no tool that rests and no mass within that of a hand.\n"
      "\n"
      "Examples:\n"
      "  voxtouch identify --device phantom --out mine.yaml --plots mine.html\n"
      "  voxtouch up cup --device phantom --device-file mine.yaml"}},
    {"accuracy",
     {"Measure what accuracy costs in time, for each contact model",
      "The tool touches the scene at --contacts random places, --depth-edges voxels deep. The "
      "virtual tool is\n"
      "pressed 5 voxels deep and compared with a reference tool that follows the same hand: the "
      "exact\n"
      "ball for a declared sphere, otherwise a god-object on the meshes' triangles.\n"
      "\n"
      "  missed     contacts of the reference without a force; they count in all columns below "
      "[%]\n"
      "  direction  angle between the force and the true one; 180 if missed [deg]\n"
      "  force      mean force over the true one: 1 without bias\n"
      "  noise      standard deviation of that ratio over its mean\n"
      "  torque     error of the torque over the force [mm]\n"
      "  onset      gap at which the force begins: > 0 early, < 0 late [mm]\n"
      "  time       CPU time of a frame [us]; compare ratios only\n"
      "  memory     voxmap, pointshell, distance field; build: CPU time until the first frame [s]\n"
      "\n"
      "Rows marked * are on the Pareto front of time and direction. 60 contacts are repeated at "
      "depths of 1/4\n"
      "to 4 voxels, and with the grid shifted by four random fractions of a voxel. Exit status 1 "
      "if no\n"
      "setting meets --want-... or nothing could be measured.\n"
      "\n"
      "Examples:\n"
      "  voxtouch accuracy cup --want-direction-deg 1\n"
      "  voxtouch accuracy part.yaml --within-us 10 --page accuracy.png"}},
    {"plan",
     {"List what a scene builds and computes, with time and memory",
      "Lists each part with its reason, its bytes, and its time per frame: bound, expected, "
      "measured. Also\n"
      "topics, nodes, and what is not built. Exit status 1 if --device cannot run the scene.\n"
      "\n"
      "Example:\n"
      "  voxtouch plan cup --device sim-phantom"}},
    {"schema",
     {"Print the JSON schema of scene files",
      "Editors with a YAML language server complete and check scenes by it. The shipped scenes "
      "name it in\n"
      "their first line (deploy/scenes/scene.schema.json)."}},
    {"change",
     {"Change effects or the scene of a running ring",
      "Gains and parameters reach their value in 0.1 s. A reloaded scene fades in over 0.2 s. Exit "
      "status 1 if\n"
      "the change was refused, or if no node replies within 2 s. The second effect of a kind is "
      "named with its\n"
      "number (viscosity2). Changes of the `device` and `coupling` sections need a restart.\n"
      "\n"
      "Examples:\n"
      "  voxtouch change viscosity off\n"
      "  voxtouch change viscosity gain 0.5\n"
      "  voxtouch change viscosity damping_ns_per_m=2\n"
      "  voxtouch change --reload --voxel-size 0.001 --model field"}},
    {"types",
     {"Write the message types as a Python package",
      "voxtouch announces no types on the network. Programs in other languages get them from "
      "here.\n"
      "\n"
      "Example:\n"
      "  voxtouch types --python ."}},
    {"view",
     {"Show a running ring or a recording in the browser",
      "Prints the page's address and serves it until Ctrl-C. The address contains a random token; "
      "the page is\n"
      "served on this machine only, unless --address is given. Needs libjs-three and "
      "libjs-dygraphs.\n"
      "\n"
      "Examples:\n"
      "  voxtouch view                    the ring of this rig, also one that starts later\n"
      "  voxtouch view part.yaml          with this scene's meshes, if the ring runs on another "
      "host\n"
      "  voxtouch view RECORDING          a recording, with playback controls"}},
    {"report",
     {"Write an HTML report of a recording",
      "One page without external files: forces, depth, latency, energy, coupling, faults, and the "
      "command that\n"
      "repeats the run. `voxtouch up` writes it for each recording. Needs python3-matplotlib.\n"
      "\n"
      "Examples:\n"
      "  voxtouch report RECORDING\n"
      "  voxtouch report RECORDING --compare-with OTHER    two runs on one scale"}},
    {"replay",
     {"Replay a recording and compare it bit by bit",
      "The recorded hand passes through rendering and coupling once more, offline. Exit status 0 "
      "if each\n"
      "contact and each command is bit-identical. The hand does not react to the replayed force.\n"
      "\n"
      "Examples:\n"
      "  voxtouch replay RECORDING\n"
      "  voxtouch replay RECORDING --scene changed.yaml --plot out.png\n"
      "  voxtouch replay RECORDING --against ../other/build"}},
    {"status",
     {"List the nodes that run, with state and rate",
      "Listens for 2.5 s. Exit status 1 if no node is found, or if a node has failed or hangs.\n"
      "\n"
      "Examples:\n"
      "  voxtouch status\n"
      "  voxtouch status --watch\n"
      "  voxtouch status --rig left --json"}},
    {"recover",
     {"Reset a fault latch, so that force returns",
      "Device or coupling latch at zero force after an unstable contact, after commands above the "
      "device's\n"
      "limit, or after a command that the driver refused. Find the cause first (voxtouch status, "
      "fault\n"
      "records) and release the device. Then the force ramps in. Exit status 1 if nothing is "
      "latched or no\n"
      "node replies.\n"
      "\n"
      "Example:\n"
      "  voxtouch recover --rig left"}},
    {"doctor",
     {"Check this machine and its network for a ring",
      "Checks kernel, real-time rights, CPU governor, network cards, multicast, ports, buffers and "
      "haptic\n"
      "devices on USB, and sends a message between two processes. Prints the environment for ROS 2 "
      "tools\n"
      "that do not find the ring. Takes 4 s. Exit status 1 if a ring cannot run."}},
    {"keys",
     {"Make keys and certificates for DDS Security",
      "Nothing is overwritten. Certificates and crl.pem are read when a node starts.\n"
      "\n"
      "Examples:\n"
      "  voxtouch keys --out keys\n"
      "  voxtouch up cup --security keys\n"
      "  voxtouch keys --out keys --renew coupling\n"
      "  voxtouch keys --out keys --revoke coupling --renew coupling    after a host was lost"}},
};

/// Options with a separate group, below the most used ones.
const std::map<std::string_view, const char*> kGroups = {
    {"--rig", "Network"},
    {"--domain", "Network"},
    {"--interface", "Network"},
    {"--discovery-peer", "Network"},
    {"--security", "Network"},
    {"--ros", "Network"},
    {"--network-delay", "Network"},
    {"--record-format", "Recording"},
    {"--record-split-mb", "Recording"},
    {"--record-split-s", "Recording"},
    {"--topic", "Recording"},
    {"--no-record", "Recording"},
    {"--no-report", "Recording"},
    {"--fault-records", "Recording"},
    {"--release-time", "Simulated hand"},
    {"--grip-change-time", "Simulated hand"},
    {"--grip-factor", "Simulated hand"},
    {"--seed", "Advanced"},
    {"--realtime", "Advanced"},
    {"--cpu", "Advanced"},
    {"--one-process", "Advanced"},
    {"--validate-every", "Advanced"},
    {"--device-option", "Advanced"},
    {"--with-parent", "Advanced"},
};

}  // namespace

void describe_verbs(CLI::App& app) {
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    const auto help = kVerbs.find(verb->get_name());
    if (help == kVerbs.end())
      throw std::logic_error("verb without help: " + verb->get_name());
    verb->description(help->second.summary);
    verb->footer(help->second.details);
    for (CLI::Option* option : verb->get_options())
      if (const auto group = kGroups.find(option->get_name()); group != kGroups.end())
        option->group(group->second);
  }
}

}  // namespace voxtouch::cli

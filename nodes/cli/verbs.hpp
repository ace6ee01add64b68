#pragma once
/// The verbs of `voxtouch`. Each adds itself to the command line and sets `action` when it was
/// chosen.
#include <functional>
#include <span>

namespace CLI {
class App;
}

namespace voxtouch::cli {

/// Runs the chosen verb; its result is the exit status.
using Action = std::function<int()>;

/// Adds a verb with its options to `app`.
using AddVerb = void(CLI::App& app, Action& action);

AddVerb add_up, add_new, add_build, add_probe, add_design, add_accuracy, add_plan, add_schema,
    add_change, add_types, add_view, add_report, add_replay, add_status, add_recover, add_doctor,
    add_keys, add_identify, add_try;

/// Parses the command line of a program that has these verbs and runs the chosen one. Returns the
/// exit status.
int run(int argc, char** argv, std::span<AddVerb* const> verbs);

}  // namespace voxtouch::cli

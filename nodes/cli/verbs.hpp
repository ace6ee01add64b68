#pragma once
/// The verbs of `voxtouch`. Each adds itself to the command line and sets `action` when it was chosen.
#include <functional>

namespace CLI {
class App;
}

namespace voxtouch::cli {

/// Runs the chosen verb; its result is the exit status.
using Action = std::function<int()>;

void add_up(CLI::App& app, Action& action);
void add_new(CLI::App& app, Action& action);
void add_build(CLI::App& app, Action& action);
void add_probe(CLI::App& app, Action& action);
void add_design(CLI::App& app, Action& action);
void add_accuracy(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);
void add_change(CLI::App& app, Action& action);
void add_types(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_status(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);

}  // namespace voxtouch::cli

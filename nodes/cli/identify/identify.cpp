#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "devices/registry.hpp"
#include "nodes/cli/identify/identify_report.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/output_file.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/device/described_device.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

namespace id = identification;

constexpr double kUsualForceRatio = 0.2;

struct IdentifyOptions {
  std::string device = "sim-phantom";
  std::filesystem::path out, plots;
  std::vector<std::string> settings;
  std::string axes = "xyz";
  double force_n = 0.0;  ///< 0: a fifth of the device's
  double box_m = 0.02;
  double payload_kg = 0.0;
  bool released = true, real_time = false, skip_hand_check = false;
};

devices::DeviceSettings settings_of(const std::vector<std::string>& texts) {
  devices::DeviceSettings out;
  for (const std::string& text : texts) {
    const std::size_t at = text.find('=');
    if (at == std::string::npos)
      throw std::runtime_error(fmt::format("--device-option {}: expected KEY=VALUE", text));
    out.emplace_back(text.substr(0, at), text.substr(at + 1));
  }
  return out;
}

std::string today() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
}

/// The released device of a run; with a payload, a mass that moves with the tool of a simulated
/// device.
devices::DeviceOptions options_for(const IdentifyOptions& o, const std::string& device,
                                   bool virtual_time, double payload_kg) {
  devices::DeviceOptions out;
  out.seed = 1;
  out.settings = settings_of(o.settings);
  out.lockstep = virtual_time && !device.starts_with("sim");
  out.described = device_node::description_of(device);
  if (!devices::has_simulated_hand(device))
    return out;
  sim::OperatorConfig hand;
  hand.released = payload_kg == 0.0;
  hand.mass_kg = payload_kg;
  out.hand = hand;
  return out;
}

int identify(const IdentifyOptions& o, const std::string& command) {
  const std::string device = device_argument(o.device);
  const bool simulated = devices::has_simulated_hand(device);
  const bool virtual_time = simulated && !o.real_time;
  std::unique_ptr<OutputFile> file;
  if (!o.out.empty())
    file = std::make_unique<OutputFile>(o.out);
  if (!o.plots.empty())
    check_picture(o.plots, true);
  runtime::catch_signals();
  const auto report = [](const std::string& text) { console::log("identify: {}\n", text); };
  DeviceRunOptions run;
  run.virtual_time = virtual_time;
  run.with_curves = !o.plots.empty();
  run.hand_check = !simulated && !o.skip_hand_check;
  if (simulated)
    report("hand check skipped (simulated device)");
  IdentifyContext context{
      .assumed = devices::describe_device(device, options_for(o, device, virtual_time, 0.0)),
      .serial = {},
      .date = today(),
      .command = command,
      .allowed_force_n = 0.0};
  const auto measure = [&](double payload_kg) {
    const auto driver =
        devices::open_device(device, options_for(o, device, virtual_time, payload_kg));
    context.assumed = driver->description();
    context.assumed.simulated = devices::can_be_led(device);
    context.serial = driver->serial();
    const DeviceDescription& d = context.assumed;
    context.allowed_force_n = o.force_n > 0.0 ? o.force_n : kUsualForceRatio * d.max_force_n;
    if (context.allowed_force_n > d.max_force_n)
      throw std::runtime_error(
          fmt::format("--force {} N exceeds the device's limit of {} N", o.force_n, d.max_force_n));
    run.session.limits = {
        .period_s = 1.0 / d.rate_hz, .allowed_force_n = context.allowed_force_n, .box_m = o.box_m};
    for (std::size_t a = 0; a < 3; ++a)
      run.session.axes[a] = o.axes.find("xyz"[a]) != std::string::npos;
    if (!virtual_time)
      for (const std::string& refused : runtime::enter_realtime({}))
        report(refused);
    return run_identification(*driver, run, runtime::stop_requested(), report);
  };
  const DeviceRunResult result = measure(0.0);
  context.answers_at_once = context.assumed.simulated;
  std::string text = figures_text(result, run.session, context);
  const bool measured = all_measured(result, run.session);
  if (measured && o.payload_kg > 0.0) {
    report(fmt::format("second run, with {} kg at the tool", o.payload_kg));
    const DeviceRunResult loaded = measure(o.payload_kg);
    for (std::size_t a = 0; a < 3; ++a) {
      if (!run.session.axes[a])
        continue;
      const id::Estimate &before = result.axes[a].mass_kg, &after = loaded.axes[a].mass_kg;
      const double gained = after.value - before.value;
      const double error = std::hypot(before.half_width, after.half_width);
      if (loaded.axes[a].outcome != id::Outcome::kMeasured || !(gained > error)) {
        text += fmt::format("force scale {}: not measured\n", "xyz"[a]);
        continue;
      }
      text += fmt::format("force scale {}: {:.3f} +- {:.3f}\n", "xyz"[a], o.payload_kg / gained,
                          o.payload_kg / gained * error / gained);
    }
  }
  if (measured)
    text += design_table(context.assumed, measured_description(result, run.session, context, false),
                         measured_description(result, run.session, context, true));
  console::print_result("{}", text);
  if (std::ranges::any_of(
          result.axes,
          [](const id::AxisFigures& f) { return f.outcome == id::Outcome::kMeasured; }) &&
      !o.plots.empty())
    console::log("{}\n",
                 draw_picture("identify", plots_json(result, run.session, context, text), o.plots));
  if (!measured)
    return 1;
  if (file) {
    file->keep(device_file_text(result, run.session, context));
    console::log("device file: {}\n", o.out.string());
  }
  return 0;
}

}  // namespace

void add_identify(CLI::App& app, Action& action) {
  auto o = std::make_shared<IdentifyOptions>();
  CLI::App* verb = app.add_subcommand("identify");
  verb->add_option("--device", o->device,
                   "Device name, or sim:FILE for a simulation of a device file")
      ->capture_default_str();
  verb->add_option("--device-option", o->settings,
                   "KEY=VALUE of the device, repeatable (deploy/devices)");
  verb->add_option("--out", o->out, "Writes a device file, for `design` and sim:FILE");
  verb->add_option("--plots", o->plots,
                   "Plots strokes, residuals, friction and response of each measured axis: .png,\n"
                   ".svg, .pdf, or .html with the report");
  verb->add_option("--axes", o->axes, "Axes of frame D to measure")
      ->capture_default_str()
      ->check([](const std::string& text) {
        return text.empty() || text.find_first_not_of("xyz") != std::string::npos
                   ? "one or more of x, y, z"
                   : "";
      });
  verb->add_option("--force", o->force_n,
                   "Largest force [N]; default: a fifth of the device's limit")
      ->check(runtime::require_positive);
  verb->add_option("--box", o->box_m, "Largest distance from the start on each axis [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.002, 0.1));
  verb->add_option("--payload", o->payload_kg,
                   "Mass added to the tool for a second run, which measures the force scale [kg]")
      ->check(runtime::require_positive);
  verb->add_flag("--released", o->released, "The tool is released (the default)");
  verb->add_flag("--real-time", o->real_time, "Runs a simulated device in real time");
  verb->add_flag(
      "--skip-hand-check", o->skip_hand_check,
      "Skips the hand check; a frozen or wrongly scaled encoder is then detected too late");
  verb->callback([o, verb, &action] {
    std::string command = "voxtouch identify";
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& value : option->results())
        command += fmt::format(" {} {}", option->get_name(), value);
    action = [o, command] { return identify(*o, command); };
  });
}

}  // namespace voxtouch::cli

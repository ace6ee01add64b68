#include "nodes/cli/up/launcher.hpp"

#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <thread>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/realtime.hpp"

extern char** environ;

namespace voxtouch::cli {
namespace {

constexpr std::chrono::milliseconds kStopTimeout{8'000};

class ChildProcess final : public RunningNode {
 public:
  ChildProcess(std::string name, const std::filesystem::path& program,
               const std::vector<std::string>& arguments,
               std::chrono::milliseconds patience = kStopTimeout)
      : name_(std::move(name)),
        patience_(patience) {
    std::vector<std::string> texts = {program.string()};
    texts.insert(texts.end(), arguments.begin(), arguments.end());
    texts.insert(texts.end(), {"--with-parent", fmt::to_string(getpid())});
    std::vector<char*> argv;
    for (std::string& text : texts)
      argv.push_back(text.data());
    argv.push_back(nullptr);
    // A new process group: Ctrl-C reaches `up` only, which stops its children in order. stdout goes
    // to stderr, because `up --json` uses it.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // SIGTERM waits until the child can act on it: a stop during the start is a stop, not a death.
    sigset_t blocked;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGTERM);
    posix_spawnattr_setsigmask(&attributes, &blocked);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    const int error =
        posix_spawn(&pid_, program.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0)
      throw std::runtime_error(
          fmt::format("Cannot start {} ({}). It must be in the same folder as voxtouch",
                      program.string(), std::strerror(error)));
  }
  ~ChildProcess() override {
    request_stop();
    join(patience_);  // after an exception the device still has to reach zero force
  }
  const std::string& name() const noexcept override { return name_; }
  void request_stop() override {
    if (!status_)
      ::kill(pid_, SIGTERM);
  }
  std::optional<int> ended() override {
    int raw = 0;
    if (!status_ && waitpid(pid_, &raw, WNOHANG) == pid_)
      status_ = WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
    return status_;
  }
  std::uint32_t pid() const noexcept override { return static_cast<std::uint32_t>(pid_); }

 private:
  void kill() override { ::kill(pid_, SIGKILL); }
  std::string name_;
  std::chrono::milliseconds patience_;
  pid_t pid_ = 0;
  std::optional<int> status_;
};

class ThreadOfThisProcess final : public RunningNode {
 public:
  using Run = std::function<int(const std::atomic<bool>&)>;
  ThreadOfThisProcess(std::string name, runtime::NodeOptions& options, Run run)
      : name_(std::move(name)),
        thread_([this, &options, run = std::move(run)] {
          if (stop_.load())
            return status_.store(0, std::memory_order_release);
          int status = 1;
          try {
            options.warnings = runtime::enter_realtime(options.scheduling());
            status = run(stop_);
          } catch (const std::exception& error) {
            console::log("error: {}: {}\n", name_, error.what());
          }
          status_.store(status, std::memory_order_release);
        }) {}
  ~ThreadOfThisProcess() override {
    request_stop();
    join(kStopTimeout);
    if (!ended()) {
      // A thread cannot be ended by force, and nothing may be destroyed while it runs: the process
      // ends instead.
      console::log("error: {} did not stop; the process ends without it\n", name_);
      console::flush_log();
      std::_Exit(1);
    }
    thread_.join();
  }
  const std::string& name() const noexcept override { return name_; }
  void request_stop() override { stop_.store(true); }
  std::optional<int> ended() override {
    const int status = status_.load(std::memory_order_acquire);
    return status < 0 ? std::nullopt : std::optional(status);
  }
  std::uint32_t pid() const noexcept override { return static_cast<std::uint32_t>(getpid()); }

 private:
  void kill() override { stop_.store(true); }  // by force only in the destructor, with the process
  std::string name_;
  std::atomic<bool> stop_{false};
  std::atomic<int> status_{-1};
  std::thread thread_;
};

std::vector<std::string> device_arguments(const device_node::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, true);
  a.insert(a.end(), {"--device", o.device, "--duration", fmt::format("{}", o.duration_s)});
  if (!o.motion.empty())
    a.insert(a.end(), {"--motion", o.motion});
  device_node::append_arguments(o.hand, a);
  for (const std::string& setting : o.settings)
    a.insert(a.end(), {"--device-option", setting});
  if (!o.device_file.empty())
    a.insert(a.end(), {"--device-file", o.device_file.string()});
  if (o.network_delay_ms > 0.0)
    a.insert(a.end(), {"--network-delay", fmt::format("{}", o.network_delay_ms)});
  if (!o.fault_records.empty())
    a.insert(a.end(), {"--fault-records", o.fault_records.string()});
  return a;
}

std::vector<std::string> coupling_arguments(const coupling_node::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, true);
  if (!o.fault_records.empty())
    a.insert(a.end(), {"--fault-records", o.fault_records.string()});
  return a;
}

std::vector<std::string> rendering_arguments(const rendering_node::Options& o) {
  return runtime::to_arguments(o, true);
}

std::vector<std::string> logger_arguments(const logger::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, false);
  a.insert(a.end(), {"--bag", o.bag.string()});
  if (o.bag_is_made)
    a.push_back("--bag-is-made");
  for (const std::string& word : logger::to_arguments(o.format))
    a.push_back(word);
  for (const std::string& topic : o.topics)
    a.insert(a.end(), {"--topic", topic});
  return a;
}

std::vector<std::string> validator_arguments(const validator::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, true);
  a.insert(a.end(), {"--every", fmt::to_string(o.every)});
  return a;
}

}  // namespace

int RunningNode::join(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!ended()) {
    if (std::chrono::steady_clock::now() >= until) {
      kill();
      for (int i = 0; i < 200 && !ended(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      return ended().value_or(1) == 0 ? 1 : ended().value_or(1);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return *ended();
}

std::unique_ptr<RunningNode> start_page(const runtime::NodeOptions& o, bool leads_hand,
                                        bool browser, const std::filesystem::path& choice) {
  constexpr std::chrono::milliseconds kPatience{2'000};
  std::vector<std::string> arguments = {"view",        o.scene.string(),   "--rig",
                                        o.rig,         "--domain",         fmt::to_string(o.domain),
                                        "--interface", o.network_interface};
  if (leads_hand)
    arguments.emplace_back("--lead-hand");
  if (browser)
    arguments.emplace_back("--browser");
  if (!choice.empty())
    arguments.insert(arguments.end(), {"--choice", choice.string()});
  for (const std::string& peer : o.discovery_peers)
    arguments.insert(arguments.end(), {"--discovery-peer", peer});
  if (!o.security.empty())
    arguments.insert(arguments.end(), {"--security", o.security.string()});
  if (o.ros == bus::RosGraph::kHumble)
    arguments.insert(arguments.end(), {"--ros", "humble"});
  return std::make_unique<ChildProcess>("view", program_folder() / "voxtouch", arguments,
                                        kPatience);
}

namespace {

/// How each node is started: arguments of its process, function of its thread.
struct NodeStart {
  std::string_view name;
  runtime::NodeOptions& (*options)(LauncherOptions& o);
  std::vector<std::string> (*arguments)(const LauncherOptions& o);
  int (*run)(LauncherOptions& o, const std::atomic<bool>& stop);
};

using StopFlag = const std::atomic<bool>&;
constexpr NodeStart kNodes[] = {
    {"logger", [](LauncherOptions& o) -> runtime::NodeOptions& { return o.logger; },
     [](const LauncherOptions& o) { return logger_arguments(o.logger); },
     [](LauncherOptions& o, StopFlag stop) { return logger::run(o.logger, stop); }},
    {"validator", [](LauncherOptions& o) -> runtime::NodeOptions& { return o.validator; },
     [](const LauncherOptions& o) { return validator_arguments(o.validator); },
     [](LauncherOptions& o, StopFlag stop) { return validator::run(o.validator, stop); }},
    {"coupling", [](LauncherOptions& o) -> runtime::NodeOptions& { return o.coupling; },
     [](const LauncherOptions& o) { return coupling_arguments(o.coupling); },
     [](LauncherOptions& o, StopFlag stop) { return coupling_node::run(o.coupling, stop); }},
    {"rendering", [](LauncherOptions& o) -> runtime::NodeOptions& { return o.rendering; },
     [](const LauncherOptions& o) { return rendering_arguments(o.rendering); },
     [](LauncherOptions& o, StopFlag stop) { return rendering_node::run(o.rendering, stop); }},
    {"device", [](LauncherOptions& o) -> runtime::NodeOptions& { return o.device; },
     [](const LauncherOptions& o) { return device_arguments(o.device); },
     [](LauncherOptions& o, StopFlag stop) { return device_node::run(o.device, stop); }},
};

}  // namespace

std::unique_ptr<RunningNode> start_node(LauncherOptions& o, const std::string& name) {
  const NodeStart& node = *std::ranges::find(kNodes, name, &NodeStart::name);
  if (!o.one_process)
    return std::make_unique<ChildProcess>(name, program_folder() / ("voxtouch_" + name),
                                          node.arguments(o));
  return std::make_unique<ThreadOfThisProcess>(
      name, node.options(o), [&o, run = node.run](StopFlag stop) { return run(o, stop); });
}

std::vector<std::unique_ptr<RunningNode>> launch(LauncherOptions& o) {
  // Device, rendering and coupling run in turn: on one processor no sample then needs to wake
  // another CPU.
  if (o.one_process && !o.device.realtime.cpu)
    o.device.realtime.loop_cpu = o.rendering.realtime.loop_cpu = o.coupling.realtime.loop_cpu =
        sched_getcpu();
  o.logger.realtime.mode = o.validator.realtime.mode = runtime::Realtime::kOff;  // taps
  std::vector<std::unique_ptr<RunningNode>> nodes;
  for (const NodeStart& node : kNodes)
    if (node.name != "device" && (o.record || node.name != "logger"))
      nodes.push_back(start_node(o, std::string(node.name)));
  return nodes;
}

}  // namespace voxtouch::cli

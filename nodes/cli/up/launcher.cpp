#include "nodes/cli/up/launcher.hpp"

#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <thread>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/held_start.hpp"
#include "nodes/runtime/realtime.hpp"

extern char** environ;

namespace voxtouch::cli {
namespace {

constexpr std::chrono::milliseconds kStopTimeout{8'000};

class ChildProcess final : public RunningNode {
 public:
  ChildProcess(std::string name, const std::filesystem::path& program,
               const std::vector<std::string>& arguments, runtime::Starter starter,
               std::chrono::milliseconds patience = kStopTimeout)
      : name_(std::move(name)),
        patience_(patience),
        starter_(std::move(starter)) {
    std::vector<std::string> texts = {program.string()};
    texts.insert(texts.end(), arguments.begin(), arguments.end());
    texts.insert(texts.end(), {"--with-parent", fmt::to_string(getpid())});
    if (starter_.input() >= 0)
      texts.push_back("--held");
    std::vector<char*> argv;
    for (std::string& text : texts)
      argv.push_back(text.data());
    argv.push_back(nullptr);
    // Its own process group: Ctrl-C reaches `up` alone, which stops its children in order. stdout
    // goes to stderr: `up --json` owns it.
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
    if (starter_.input() >= 0)
      posix_spawn_file_actions_adddup2(&actions, starter_.input(), STDIN_FILENO);
    else
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    const int error =
        posix_spawn(&pid_, program.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    starter_.close_input();
    if (error != 0)
      throw std::runtime_error(
          fmt::format("{} could not be started ({}); it should stand beside voxtouch",
                      program.string(), std::strerror(error)));
  }
  ~ChildProcess() override {
    request_stop();
    join(patience_);  // where an exception got us here the device still has to reach zero by itself
  }
  const std::string& name() const noexcept override { return name_; }
  void request_stop() override {
    if (!status_)
      ::kill(pid_, SIGTERM);
  }
  void let_begin() override { starter_.let_begin(); }
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
  runtime::Starter starter_;
  pid_t pid_ = 0;
  std::optional<int> status_;
};

class ThreadOfThisProcess final : public RunningNode {
 public:
  using Run = std::function<int(const std::atomic<bool>&)>;
  ThreadOfThisProcess(std::string name, runtime::NodeOptions& options, Run run)
      : name_(std::move(name)),
        thread_([this, &options, run = std::move(run)] {
          int status = 1;
          try {
            options.warnings = runtime::enter_realtime(options.scheduling());
            status = run(stop_);
          } catch (const std::exception& error) {
            log::tell("error: {}: {}\n", name_, error.what());
          }
          status_.store(status, std::memory_order_release);
        }) {}
  ~ThreadOfThisProcess() override {
    stop_.store(true);
    join(kStopTimeout);
    if (!ended()) {
      // A thread cannot be ended by force, and nothing may be destroyed under it: the process goes
      // instead.
      log::tell("error: {} did not stop; the process ends without it\n", name_);
      log::finish_telling();
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
  if (o.network_delay_ms > 0.0)
    a.insert(a.end(), {"--network-delay", fmt::format("{}", o.network_delay_ms)});
  if (!o.fault_records.empty())
    a.insert(a.end(), {"--fault-records", o.fault_records.string()});
  return a;
}

std::vector<std::string> coupling_arguments(const coupling_node::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, true);
  runtime::append_arguments(o.standby, a);
  if (!o.fault_records.empty())
    a.insert(a.end(), {"--fault-records", o.fault_records.string()});
  return a;
}

std::vector<std::string> rendering_arguments(const rendering_node::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, true);
  runtime::append_arguments(o.standby, a);
  scene_build::append_arguments(o.cache, a);
  return a;
}

std::vector<std::string> logger_arguments(const logger::Options& o) {
  std::vector<std::string> a = runtime::to_arguments(o, false);
  a.insert(a.end(), {"--bag", o.bag.string()});
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

std::unique_ptr<RunningNode> start_page(const runtime::NodeOptions& o,
                                        const scene_build::CacheOptions& cache) {
  constexpr std::chrono::milliseconds kPatience{2'000};
  std::vector<std::string> arguments = {"view",        o.scene.string(),   "--rig",
                                        o.rig,         "--domain",         fmt::to_string(o.domain),
                                        "--interface", o.network_interface};
  for (const std::string& peer : o.discovery_peers)
    arguments.insert(arguments.end(), {"--discovery-peer", peer});
  if (!o.security.empty())
    arguments.insert(arguments.end(), {"--security", o.security.string()});
  if (o.ros == bus::RosGraph::kHumble)
    arguments.insert(arguments.end(), {"--ros", "humble"});
  scene_build::append_arguments(cache, arguments);
  return std::make_unique<ChildProcess>("view", program_folder() / "voxtouch", arguments,
                                        runtime::Starter(), kPatience);
}

std::vector<std::unique_ptr<RunningNode>> launch(LauncherOptions& o) {
  std::vector<std::unique_ptr<RunningNode>> nodes;
  const auto start = [&](const std::string& name, runtime::NodeOptions& options, auto arguments,
                         ThreadOfThisProcess::Run run) {
    if (o.one_process)
      nodes.push_back(std::make_unique<ThreadOfThisProcess>(name, options, std::move(run)));
    else
      nodes.push_back(std::make_unique<ChildProcess>(name, program_folder() / ("voxtouch_" + name),
                                                     arguments(), runtime::Starter::make()));
  };
  const auto start_standby = [&](const std::string& role,
                                 const std::vector<std::string>& arguments) {
    nodes.push_back(std::make_unique<ChildProcess>(runtime::standby_of(role),
                                                   program_folder() / ("voxtouch_" + role),
                                                   arguments, runtime::Starter::make()));
  };
  using Stop = const std::atomic<bool>&;
  // Device, rendering and coupling take turns: on one processor a sample need not wake another to
  // go on.
  if (o.one_process && !o.device.realtime.cpu)
    o.device.realtime.loop_cpu = o.rendering.realtime.loop_cpu = o.coupling.realtime.loop_cpu =
        sched_getcpu();
  o.logger.realtime.mode = o.validator.realtime.mode = runtime::Realtime::kOff;  // taps
  // What is recorded is recorded from its first sample on. In lockstep `up` has said who takes
  // part.
  for (runtime::NodeOptions* one : std::initializer_list<runtime::NodeOptions*>{
           &o.device, &o.rendering, &o.coupling,
           o.rendering_standby ? &*o.rendering_standby : nullptr,
           o.coupling_standby ? &*o.coupling_standby : nullptr})
    if (one != nullptr && o.record && !one->lockstep)
      one->peers = {"logger"};
  if (o.record)
    start(
        "logger", o.logger, [&] { return logger_arguments(o.logger); },
        [&o](Stop stop) { return logger::run(o.logger, stop); });
  start(
      "validator", o.validator, [&] { return validator_arguments(o.validator); },
      [&o](Stop stop) { return validator::run(o.validator, stop); });
  start(
      "coupling", o.coupling, [&] { return coupling_arguments(o.coupling); },
      [&o](Stop stop) { return coupling_node::run(o.coupling, stop); });
  start(
      "rendering", o.rendering, [&] { return rendering_arguments(o.rendering); },
      [&o](Stop stop) { return rendering_node::run(o.rendering, stop); });
  if (o.coupling_standby)
    start_standby("coupling", coupling_arguments(*o.coupling_standby));
  if (o.rendering_standby)
    start_standby("rendering", rendering_arguments(*o.rendering_standby));
  start(
      "device", o.device, [&] { return device_arguments(o.device); },
      [&o](Stop stop) { return device_node::run(o.device, stop); });
  return nodes;
}

}  // namespace voxtouch::cli

// A bare ring of Cyclone DDS for comparison: the same three topics with their types, QoS and
// network settings, the same scheduling, and no computation or checks. Three processes, or three
// participants in one. Nodes are woken by wait sets, as ours, or answer in DDS's thread. Prints one
// JSON object. With --watch it prints that of our ring. tests/bench/ring_turns.py runs both in
// turns.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include <CLI/CLI.hpp>

#include "nodes/bus/writer.hpp"
#include "nodes/runtime/latency.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/realtime.hpp"
#include "tests/support/process/process.hpp"
#include "tests/support/woken.hpp"

namespace voxtouch::bench {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
constexpr std::uint64_t kLeftOut = 500;  ///< samples at the start

struct Options {
  std::string method = "waitset", watched;
  std::string role;  ///< of a process that this program starts
  bool one_process = false;
  std::uint32_t domain = 93;
  double seconds = 3.0;
  std::optional<int> cpu;
};

bus::Participant join(const Options& o, const std::string& name) {
  runtime::enter_realtime({.cpu = o.cpu});
  return bus::Participant({.domain = o.domain, .name = "bare_" + name});
}

/// Takes each sample of one topic and writes one of the next, with its number and time.
template <class In, class Out>
void relay(const Options& o, const std::string& name, const qos::Topic& in, const qos::Topic& out,
           const std::function<bool()>& done) {
  const bus::Participant participant = join(o, name);
  bus::Writer<Out> writer(participant, out, "bare", qos::profile(qos::ProfileId::kStream));
  test::Woken<In> reader(participant, in, "bare", o.method, [&](const In& sample) {
    Out answer{};
    answer.session_id = sample.session_id;
    answer.sequence_number = sample.sequence_number;
    answer.sample_time_ns = sample.sample_time_ns;
    writer.write(answer);
  });
  reader.run_until(runtime::monotonic_ns() + static_cast<std::int64_t>((o.seconds + 30.0) * 1e9),
                   done);
}

void run_role(const Options& o, const std::string& role, const std::function<bool()>& done) {
  if (role == "rendering")
    relay<msg::DeviceState, msg::ContactState>(o, role, qos::kDeviceState, qos::kContactState,
                                               done);
  else
    relay<msg::ContactState, msg::ForceCommand>(o, role, qos::kContactState, qos::kForceCommand,
                                                done);
}

/// A device's part: writes at an absolute deadline, and waits for the command as `DeviceLoop` does.
int device(const Options& o) {
  const bus::Participant participant = join(o, "device");
  bus::Writer<msg::DeviceState> writer(participant, qos::kDeviceState, "bare",
                                       qos::profile(qos::ProfileId::kStream));
  runtime::LatencyHistogram latency;
  std::uint64_t back = 0, sent = 0, newest = 0;
  test::Woken<msg::ForceCommand> reader(
      participant, qos::kForceCommand, "bare", "waitset", [&](const msg::ForceCommand& command) {
        newest = command.sequence_number;
        if (++back > kLeftOut)
          latency.record(runtime::monotonic_ns() - command.sample_time_ns);
      });
  const auto expected = kLeftOut + static_cast<std::uint64_t>(o.seconds * 1e3);
  const std::int64_t begin_ns = runtime::monotonic_ns(), patience_ns = 30'000'000'000;
  std::int64_t deadline_ns = begin_ns;
  while (back < expected && deadline_ns < begin_ns + patience_ns) {
    msg::DeviceState state{};
    state.sequence_number = ++sent;
    state.sample_time_ns = runtime::monotonic_ns();
    writer.write(state);
    deadline_ns = runtime::next_deadline(deadline_ns, runtime::monotonic_ns(), kPeriodNs).at_ns;
    reader.run_until(deadline_ns, [&] { return newest == sent; });
    runtime::sleep_until(deadline_ns);
  }
  std::printf(
      "{\"rounds\": %lu, \"p50_us\": %.0f, \"p90_us\": %.0f, \"p99_us\": %.0f, \"bytes\": [%zu, "
      "%zu, %zu]}\n",
      static_cast<unsigned long>(latency.count()), latency.quantile_us(0.5),
      latency.quantile_us(0.9), latency.quantile_us(0.99), sizeof(msg::DeviceState),
      sizeof(msg::ContactState), sizeof(msg::ForceCommand));
  return back < expected ? 1 : 0;
}

int in_one_process(const Options& o) {
  std::atomic<bool> over{false};
  std::vector<std::thread> threads;
  for (const char* role : {"rendering", "coupling"})
    threads.emplace_back([&, role] { run_role(o, role, [&] { return over.load(); }); });
  int status = 1;
  std::thread([&] { status = device(o); }).join();
  over = true;
  for (std::thread& thread : threads)
    thread.join();
  return status;
}

int in_three(const Options& o) {
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe").string(),
                                    "--way",
                                    o.method,
                                    "--domain",
                                    std::to_string(o.domain),
                                    "--seconds",
                                    std::to_string(o.seconds)};
  if (o.cpu)
    words.insert(words.end(), {"--cpu", std::to_string(*o.cpu)});
  words.emplace_back("--role");
  std::vector<std::unique_ptr<test::Process>> others;
  for (const char* role : {"rendering", "coupling"}) {
    words.emplace_back(role);
    others.push_back(std::make_unique<test::Process>(words));
    words.pop_back();
  }
  return device(o);
}

/// Prints the latency reported by our device until it stops.
int watch(const Options& o) {
  const bus::Participant participant({.domain = o.domain, .name = "watch"});
  runtime::NodeRegistry registry(participant, o.watched);
  const auto stopped = [](const runtime::NodeReport& report) {
    return report.node == "device" && report.final();
  };
  std::optional<runtime::NodeReport> report;
  for (const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
       !report && std::chrono::steady_clock::now() < until;
       std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    registry.update(stopped);  // kept, although its writer has left
    for (const runtime::NodeReport& one : registry.reports())
      if (stopped(one))
        report = one;
  }
  if (!report)
    return 1;
  const auto figure = [&](const char* name) { return runtime::value_of(report->figures, name); };
  std::printf("{\"rounds\": %.0f, \"p50_us\": %.0f, \"p99_us\": %.0f}\n", figure("answered"),
              figure("latency_p50_us"), figure("latency_p99_us"));
  return 0;
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  using namespace voxtouch::bench;
  Options o;
  CLI::App app{
      "A bare ring of Cyclone DDS: what DDS alone takes to carry a sample round device, rendering "
      "and coupling."};
  app.add_option("--way", o.method, "how rendering and coupling are woken (waitset)")
      ->check(CLI::IsMember(voxtouch::test::wake_methods()));
  app.add_flag("--one-process", o.one_process, "three participants in one process");
  app.add_option("--domain", o.domain, "DDS domain (93)");
  app.add_option("--seconds", o.seconds, "that are measured (3)");
  app.add_option("--cpu", o.cpu, "pins all of it to this processor");
  app.add_option(
      "--watch", o.watched,
      "runs none: waits until the device of this rig has stopped, and prints what it measured");
  app.add_option("--role", o.role)->group("");
  CLI11_PARSE(app, argc, argv);
  if (!o.watched.empty())
    return watch(o);
  if (o.role.empty())
    return o.one_process ? in_one_process(o) : in_three(o);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  run_role(o, o.role, [] { return false; });
  return 0;
}

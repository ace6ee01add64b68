// Compares ways to wake a node: three processes pass a sample on as device, rendering and coupling
// do, once with each method, in turns; prints the time of a round. Computation is excluded. With
// --protection the same under DDS Security: a process of the ring has one set of keys, so each kind
// of protection needs a run (tests/security/cost.py).
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "nodes/bus/writer.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/latency.hpp"
#include "nodes/runtime/realtime.hpp"
#include "tests/experiments/wake_up/protection.hpp"
#include "tests/support/process/process.hpp"
#include "tests/support/woken.hpp"

extern char** environ;

namespace voxtouch::wake_up {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
const std::vector<std::string>& kWays = test::wake_methods();

qos::Topic row(std::string_view path) {
  return {path, "voxtouch_msgs/msg/DeviceState", qos::ProfileId::kStream, 1000};
}

using Woken = test::Woken<msg::DeviceState>;

struct Options {
  std::string method, relay;  ///< `relay`: "first" or "second" for a child
  std::string protection;     ///< kind; empty: plain
  std::filesystem::path keys;
  std::uint32_t domain = 93;
  double seconds = 10.0;
  int rounds = 3;
};

bus::Participant join(const Options& o) {
  runtime::enter_realtime({});
  return bus::Participant({o.domain,
                           "lo",
                           "wake_up",
                           {},
                           {},
                           o.protection.empty() ? security::Properties() : protected_by(o.keys)});
}

int relay(const Options& o) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const bus::Participant participant = join(o);
  const bool first = o.relay == "first";
  bus::Writer<msg::DeviceState> writer(participant, row(first ? "b" : "c"), o.method,
                                       qos::profile(qos::ProfileId::kStream));
  Woken reader(participant, row(first ? "a" : "b"), o.method, o.method,
               [&](const msg::DeviceState& sample) { writer.write(sample); });
  reader.run_until(runtime::monotonic_ns() + static_cast<std::int64_t>((o.seconds + 30.0) * 1e9));
  return 0;
}

pid_t start(const Options& o, const std::string& method, const std::string& relay) {
  std::vector<std::string> words = {"wake_up",
                                    "--way",
                                    method,
                                    "--relay",
                                    relay,
                                    "--domain",
                                    std::to_string(o.domain),
                                    "--seconds",
                                    std::to_string(o.seconds)};
  if (!o.protection.empty())
    words.insert(words.end(), {"--protection", o.protection, "--keys", o.keys.string()});
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  return posix_spawn(&pid, "/proc/self/exe", nullptr, nullptr, argv.data(), environ) == 0 ? pid : 0;
}

/// A device's part for `seconds`: writes at an absolute deadline, counts the answers.
void measure(const Options& o, const std::string& method, runtime::LatencyHistogram& latency) {
  const pid_t children[] = {start(o, method, "first"), start(o, method, "second")};
  {
    const bus::Participant participant = join(o);
    bus::Writer<msg::DeviceState> writer(participant, row("a"), method,
                                         qos::profile(qos::ProfileId::kStream));
    std::uint64_t back = 0;
    Woken reader(participant, row("c"), method, method, [&](const msg::DeviceState& sample) {
      if (++back > 500)
        latency.record(runtime::monotonic_ns() - sample.sample_time_ns);
    });
    const std::int64_t begin = runtime::monotonic_ns() + 2'000'000'000;
    reader.run_until(begin);
    for (std::int64_t n = 0; n < static_cast<std::int64_t>(o.seconds * 1e3); ++n) {
      runtime::sleep_until(begin + n * kPeriodNs);
      msg::DeviceState sample{};
      sample.sequence_number = static_cast<std::uint64_t>(n);
      sample.sample_time_ns = runtime::monotonic_ns();
      writer.write(sample);
      reader.run_until(begin + (n + 1) * kPeriodNs - 100'000);
    }
  }
  for (const pid_t child : children) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
}

int run(Options o) {
  const test::TemporaryFolder folder;
  o.keys = folder / "keys";
  if (!o.protection.empty())
    make_keys_of(o.protection, o.keys);
  const std::vector<std::string> methods = o.method.empty() ? kWays : std::vector{o.method};
  std::map<std::string, runtime::LatencyHistogram> of;
  for (int round = 0; round < o.rounds; ++round)
    for (const std::string& method : methods) {
      std::fprintf(stderr, "\rround %d of %d: %s          ", round + 1, o.rounds, method.c_str());
      measure(o, method, of[method]);
    }
  std::fprintf(stderr, "\r");
  std::printf("%-18s %8s %9s %9s %9s\n", "way", "rounds", "p50 us", "p99 us", "p99.9 us");
  for (const std::string& method : methods)
    std::printf("%-18s %8lu %9.0f %9.0f %9.0f\n", method.c_str(),
                static_cast<unsigned long>(of[method].count()), of[method].quantile_us(0.5),
                of[method].quantile_us(0.99), of[method].quantile_us(0.999));
  return 0;
}

}  // namespace
}  // namespace voxtouch::wake_up

int main(int argc, char** argv) {
  voxtouch::wake_up::Options o;
  CLI::App app{
      "Measures how long a sample takes round three processes over DDS, by the way in which each "
      "is woken: a wait set, a listener that wakes a "
      "thread, a listener that answers. In turns, so that what else the machine does meets all of "
      "them."};
  app.add_option("--seconds", o.seconds, "of each way in a round (10)");
  app.add_option("--rounds", o.rounds, "how often each way takes its turn (3)");
  app.add_option("--domain", o.domain, "DDS domain (93)");
  app.add_option("--way", o.method, "this one only")
      ->check(CLI::IsMember(voxtouch::wake_up::kWays));
  app.add_option("--protection", o.protection, "under DDS Security, protected like this")
      ->check(CLI::IsMember(voxtouch::wake_up::protections()));
  app.add_option("--keys", o.keys)->group("");
  app.add_option("--relay", o.relay)->group("");
  CLI11_PARSE(app, argc, argv);
  return o.relay.empty() ? voxtouch::wake_up::run(o) : voxtouch::wake_up::relay(o);
}

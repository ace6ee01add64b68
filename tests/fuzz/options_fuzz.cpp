// Texts of command-line options: the project's check, then CLI11.
#include <sched.h>

#include <CLI/CLI.hpp>

#include "nodes/runtime/options.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

void command_line(const std::string& text) {
  double positive = 1.0;
  std::uint64_t whole = 0;
  runtime::NodeOptions options;
  CLI::App app;
  app.add_option("--positive", positive)->check(runtime::require_positive);
  app.add_option("--whole", whole)->check(runtime::require_whole);
  runtime::add_node_options(app, options, false);
  for (const char* name : {"--positive=", "--whole=", "--seed=", "--domain=", "--rig=", "--cpu=",
                           "--interface=", "--discovery-peer="}) {
    try {
      app.parse(std::vector<std::string>{name + text});
    } catch (const CLI::Error&) {
      continue;
    }
    FUZZ_REQUIRE(std::isfinite(positive) && positive > 0.0);
    FUZZ_REQUIRE(options.domain <= 232);
    FUZZ_REQUIRE(!options.realtime.cpu ||
                 (*options.realtime.cpu >= 0 && *options.realtime.cpu < CPU_SETSIZE));
    FUZZ_REQUIRE(options.network_interface.find_first_of("<>&\"'/ \n") ==
                 std::string::npos);  // part of an XML text
    for (const std::string& peer : options.discovery_peers)
      FUZZ_REQUIRE(peer.find_first_of("<>&\"'/ \n") == std::string::npos);
    const std::string rig = options.rig;
    FUZZ_REQUIRE(!rig.empty() && rig.find_first_of("/ \n\"") == std::string::npos);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  command_line(std::string(reinterpret_cast<const char*>(data), std::min<std::size_t>(size, 64)));
  return 0;
}

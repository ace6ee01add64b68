#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {

std::vector<std::string> up_arguments(const std::string& scene, const std::vector<std::string>& more) {
  std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch", "up", scene, "--json", "--domain", fresh_domain()};
  a.insert(a.end(), more.begin(), more.end());
  return a;
}

nlohmann::json parse_summary(const std::string& out) { return nlohmann::json::parse(out, nullptr, false); }

RingResult run_ring(const std::string& scene, const std::vector<std::string>& more) {
  Process process(up_arguments(scene, more));
  RingResult result{process.wait(std::chrono::seconds(120)), {}};
  result.summary = parse_summary(result.process.out);
  return result;
}

std::string shipped_scene(const std::string& name) {
  return std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml";
}

}  // namespace voxtouch::test

#include "tests/ring/ring_run.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace voxtouch::test {

std::vector<std::string> on_a_busy_machine() {
  std::vector<std::string> a;
  for (const char* limit :
       {"first_answer_s=inf", "answered_ratio=0", "rate_ratio=0", "overrun_ratio=inf",
        "deadline_miss_ratio=inf", "clamped_ratio=inf", "tunnelling_suspected_samples=inf",
        "first_validation_s=inf", "validated_ratio=0", "compared_ratio=0", "first_recorded_s=inf",
        "recorded_ratio=0", "silence_s=inf", "force_losses=inf"})
    a.insert(a.end(), {"--limit", limit});
  return a;
}

std::vector<std::string> up_arguments(const std::string& scene,
                                      const std::vector<std::string>& more) {
  std::vector<std::string> a = {
      VOXTOUCH_BIN "/voxtouch", "up", scene, "--json", "--no-report", "--domain", fresh_domain()};
  if (std::find(more.begin(), more.end(), "--lockstep") == more.end()) {
    const std::vector<std::string> lifted = on_a_busy_machine();
    a.insert(a.end(), lifted.begin(), lifted.end());
  }
  a.insert(a.end(), more.begin(), more.end());
  return a;
}

nlohmann::json parse_summary(const std::string& out) {
  return nlohmann::json::parse(out, nullptr, false);
}

RingResult run_ring(const std::string& scene, const std::vector<std::string>& more) {
  Process process(up_arguments(scene, more));
  RingResult result{process.wait(std::chrono::seconds(120)), {}};
  result.summary = parse_summary(result.process.out);
  return result;
}

std::string shipped_scene(const std::string& name) {
  return std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml";
}

std::string changed_scene(const TemporaryFolder& folder, const std::string& name,
                          const std::vector<std::pair<std::string, std::string>>& replacements) {
  std::stringstream text;
  text << std::ifstream(shipped_scene(name)).rdbuf();
  std::string scene = text.str();
  const auto replace = [&](const std::string& from, const std::string& to) {
    if (scene.find(from) == std::string::npos)
      throw std::runtime_error(name + ".yaml has no '" + from + "'");
    for (std::size_t at = 0; (at = scene.find(from, at)) != std::string::npos; at += to.size())
      scene.replace(at, from.size(), to);
  };
  replace("../meshes", std::string(VOXTOUCH_DEPLOY) + "/meshes");
  for (const auto& [from, to] : replacements)
    replace(from, to);
  const auto file = folder / (name + ".yaml");
  std::ofstream(file) << scene;
  return file.string();
}

}  // namespace voxtouch::test

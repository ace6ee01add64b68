#include "tests/ring/ring_run.hpp"

#include <algorithm>

namespace voxtouch::test {

std::vector<std::string> on_a_busy_machine() {
  std::vector<std::string> a;
  for (const char* limit :
       {"first_answer_s=inf", "answered_share=0", "rate_share=0", "overrun_share=inf",
        "deadline_miss_share=inf", "clamped_share=inf", "missed_samples=inf",
        "first_validation_s=inf", "validated_share=0", "first_recorded_s=inf", "recorded_share=0",
        "silence_s=inf", "force_losses=inf"})
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

}  // namespace voxtouch::test

#pragma once
/// `voxtouch up` as a test sees it.
#include <nlohmann/json.hpp>

#include "tests/support/process/process.hpp"
#include "tests/support/whole_bag.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::test {

/// Lifts limits that depend on the machine's load; a test checks times itself.
std::vector<std::string> on_a_busy_machine();
/// Arguments of `voxtouch up --json` on a private domain, followed by `more`; in real time with the
/// limits of a busy machine.
std::vector<std::string> up_arguments(const std::string& scene,
                                      const std::vector<std::string>& more);

struct RingResult {
  Finished process;
  nlohmann::json summary;  ///< null if stdout had no JSON object
};
RingResult run_ring(const std::string& scene, const std::vector<std::string>& more);
nlohmann::json parse_summary(const std::string& out);

/// All messages of one of the ring's fixed-size topics, in order of arrival. They hold no padding,
/// so the CDR is the struct.
template <class T>
std::vector<T> read_ring_topic(const std::filesystem::path& folder, const std::string& topic) {
  std::vector<T> all;
  const auto bag = bag::WholeBag::open(folder);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  const auto messages = bag->read_topic(topic, bag::WholeBag::Order::kArrival);
  if (!messages)
    throw std::runtime_error(messages.error().sentence);
  for (const auto& message : *messages) {
    if (message.bytes.size() != sizeof(T) + 4)
      throw std::runtime_error(topic + ": a message has an unexpected size");
    T value;
    std::memcpy(&value, message.bytes.data() + 4, sizeof value);
    all.push_back(value);
  }
  return all;
}

/// deploy/scenes/<name>.yaml
std::string shipped_scene(const std::string& name);
/// Writes a shipped scene with some words replaced into `folder` and returns its path. A word that
/// the scene does not have fails the test. Paths of meshes become absolute.
std::string changed_scene(const TemporaryFolder& folder, const std::string& name,
                          const std::vector<std::pair<std::string, std::string>>& replacements);

}  // namespace voxtouch::test

#include "nodes/faults/fault_bag.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "nodes/bag/bag_writer.hpp"
#include "nodes/bag/files.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "voxtouch_msgs/definitions.hpp"

namespace voxtouch::faults {
namespace {

template <class R>
auto good(R result) {
  if (!result)
    throw std::runtime_error(result.error().sentence);
  if constexpr (!std::is_void_v<typename R::value_type>)
    return std::move(*result);
}

std::filesystem::path next_name(const std::filesystem::path& folder, const std::string& node) {
  for (int n = 1;; ++n)
    if (std::filesystem::path path = folder / fmt::format("{}_{}", node, n);
        !std::filesystem::exists(path))
      return path;
}

}  // namespace

std::filesystem::path write_fault_bag(const std::filesystem::path& folder,
                                      const FaultContext& context,
                                      const std::vector<FaultTopic>& topics,
                                      const std::vector<FaultMessage>& messages) {
  const std::filesystem::path path = next_name(folder, context.node);
  bag::BagWriter writer = good(bag::BagWriter::create(path));
  std::vector<bag::TopicId> ids;
  for (const FaultTopic& topic : topics)
    ids.push_back(
        good(writer.add_topic({.name = topic.name,
                               .type = std::string(topic.type),
                               .offered_qos = {},
                               .type_hash = std::string(topic.hash),
                               .definition = std::string(msg::definition_of(topic.type))})));
  for (const FaultMessage& message : messages)
    good(writer.append(ids[message.topic], message.time_ns, message.bytes));
  const nlohmann::ordered_json json{
      {"node", context.node},
      {"rig", context.rig},
      {"reason", context.reason},
      {"first_time_ns", messages.empty() ? 0 : messages.front().time_ns},
      {"last_time_ns", messages.empty() ? 0 : messages.back().time_ns}};
  good(bag::write_atomically(
      path / "fault.json",
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n",
      bag::Flush::kNo));
  good(writer.close());
  return path;
}

std::vector<std::string> fault_records_in(const std::filesystem::path& folder) {
  std::vector<std::string> sentences;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    std::ifstream file(entry.path() / "fault.json");
    const auto json = nlohmann::json::parse(file, nullptr, false);
    if (json.is_object())
      sentences.push_back(
          fmt::format("fault record of {}: {:.1f} s before {}, in {}", json.value("node", "node"),
                      1e-9 * (json.value("last_time_ns", 0.0) - json.value("first_time_ns", 0.0)),
                      json.value("reason", "a fault"), entry.path().string()));
  }
  std::ranges::sort(sentences);
  return sentences;
}

void add_option(CLI::App& app, std::filesystem::path& folder) {
  app.add_option(
      "--fault-records", folder,
      "Folder for fault records: one recording of the last 2 s before each fault; default: none");
}

}  // namespace voxtouch::faults

// flood: messages of an unauthorised participant, at the requested rate, on the topics of a rig.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/bus/endpoint.hpp"
#include "voxtouch_msgs/all_types.hpp"

namespace {

using namespace voxtouch;
using Clock = std::chrono::steady_clock;

struct Options {
  bus::ParticipantOptions participant{.name = "flood"};
  std::string rig = "haptic";
  double seconds = 3.0, rate = 50000.0;
  std::uint64_t seed = 1;
  std::vector<std::string> topics;
};

/// A sample with random numbers, if the type has only numbers: pointers of strings and sequences
/// stay empty.
std::vector<std::uint64_t> sample_of(const dds_topic_descriptor_t& type, std::mt19937_64& random) {
  std::vector<std::uint64_t> memory(type.m_size / sizeof(std::uint64_t) + 1);
  if (type.m_flagset & DDS_TOPIC_FIXED_SIZE)
    for (std::byte& byte : std::as_writable_bytes(std::span(memory)))
      byte = static_cast<std::byte>(random());
  return memory;
}

/// Messages written to one topic, of those intended, and their rate.
struct Flood {
  std::uint64_t written = 0, intended = 0;
  double per_s = 0.0;
};

Flood flood(const Options& o, const bus::Participant& participant, const qos::Topic& topic,
            std::mt19937_64& random) {
  const auto type = std::find_if(std::begin(msg::kAllTypes), std::end(msg::kAllTypes),
                                 [&](const msg::AnyType& t) { return t.ros_name == topic.type; });
  const bus::EndpointEntities writer =
      bus::make_writer(participant, topic, o.rig, qos::profile(topic.profile), *type);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // discovery
  const auto start = Clock::now();
  const auto count = static_cast<std::uint64_t>(std::llround(o.seconds * o.rate));
  std::uint64_t written = 0, n = 0;
  const auto sample = sample_of(*type->descriptor, random);
  for (; n < count && Clock::now() - start < 2 * std::chrono::duration<double>(o.seconds); ++n) {
    if (n % 50 == 0)
      std::this_thread::sleep_until(
          start + std::chrono::nanoseconds(std::llround(1e9 * static_cast<double>(n) / o.rate)));
    written += dds_write(writer.endpoint.get(), sample.data()) == DDS_RETCODE_OK;
  }
  const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
  const double per_s = static_cast<double>(written) / elapsed;
  fmt::print("{}: {} of {} written in {:.1f} s, {:.0f} a second, to {} readers\n", topic.path,
             written, count, elapsed, per_s, bus::matched_readers(writer.endpoint.get()).size());
  std::fflush(stdout);
  return {written, count, per_s};
}

int run(const Options& o) {
  const bus::Participant participant(o.participant);
  std::mt19937_64 random(o.seed);
  std::size_t topics = 0;
  Flood all{.per_s = o.rate};
  for (const qos::Topic& topic : qos::kTopics)
    if (o.topics.empty() ||
        std::find(o.topics.begin(), o.topics.end(), topic.path) != o.topics.end()) {
      const Flood one = flood(o, participant, topic, random);
      ++topics, all.written += one.written, all.intended += one.intended;
      all.per_s = std::min(all.per_s, one.per_s);
    }
  fmt::print("figure: {} topics, {} of {} messages written, {:.0f} a second or more\n", topics,
             all.written, all.intended, all.per_s);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "A foreign participant writes on each topic of a rig in turn, with its type, as fast as "
      "asked: numbers are random, texts and lists\n"
      "empty. No process of the ring may end of it, and none of it may reach the device.");
  Options o;
  std::vector<std::string> paths;
  for (const qos::Topic& topic : qos::kTopics)
    paths.emplace_back(topic.path);
  app.add_option("--domain", o.participant.domain, "DDS domain")
      ->required()
      ->check(CLI::Range(0U, 200U));
  app.add_option("--rig", o.rig, "of these topics")->capture_default_str();
  app.add_option("--seconds", o.seconds,
                 "for each topic; at most twice that where it cannot be so fast")
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
  app.add_option("--rate", o.rate, "messages a second")
      ->check(CLI::Range(1.0, 200000.0))
      ->capture_default_str();
  app.add_option("--seed", o.seed, "of the numbers")->capture_default_str();
  app.add_option("--topics", o.topics, "these only")->delimiter(',')->check(CLI::IsMember(paths));
  CLI11_PARSE(app, argc, argv);
  try {
    return run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}

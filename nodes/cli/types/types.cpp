#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/cli/output_file.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "qos/topics.hpp"
#include "qos_network.hpp"
#include "voxtouch_msgs/python_types.hpp"

namespace voxtouch::cli {
namespace {

// Readers do not slow writers and accept any deadline. They request the last value of a latched
// topic.
constexpr std::string_view kCode = R"py(

@dataclass(frozen=True)
class Row:
    """A topic: its name within the rig (or outside all rigs), type and policies."""

    path: str
    type: type
    outside_rig: bool
    reliable: bool
    keeps_last: bool
    depth: int
    deadline_s: float

    def dds_name(self, rig="haptic"):
        return f"rt/{self.path}" if self.outside_rig else f"rt/{rig}/{self.path}"

    def topic(self, participant, rig="haptic"):
        return Topic(participant, self.dds_name(rig), self.type)

    def reader(self, participant, rig="haptic"):
        """A reader that does not slow writers. Latched topics deliver their last value to late readers."""
        return DataReader(participant, self.topic(participant, rig), qos=self.qos(self.keeps_last))

    def writer(self, participant, rig="haptic"):
        """A writer that every reader of the topic matches."""
        return DataWriter(participant, self.topic(participant, rig), qos=self.qos(self.reliable, self.deadline_s))

    def qos(self, reliable, deadline_s=0.0):
        policies = [Policy.Reliability.Reliable(duration(milliseconds=100)) if reliable else Policy.Reliability.BestEffort,
                    Policy.Durability.TransientLocal if self.keeps_last else Policy.Durability.Volatile,
                    Policy.History.KeepLast(max(self.depth, 64)), Policy.WriterDataLifecycle(autodispose=False)]
        return Qos(*policies, *([Policy.Deadline(duration(seconds=deadline_s))] if deadline_s else []))


_domains = {}


def join(domain=0, interface="lo"):
    """A participant of the domain on that network card, with the network settings of voxtouch."""
    if domain not in _domains:
        cards = f'<Interfaces><NetworkInterface name="{interface}" multicast="true"/></Interfaces>'
        _domains[domain] = Domain(domain, NETWORK.replace("@CARDS@", cards).replace("@PEERS@", "").replace("@LAST_INDEX@", "119"))
    return DomainParticipant(domain)

)py";

std::string row_text(const qos::Topic& topic, std::string_view package, std::string_view name) {
  const qos::Profile& profile = qos::profile(topic.profile);
  const auto truth = [](bool value) { return value ? "True" : "False"; };
  return fmt::format(
      R"(    Row("{}", {}.{}, outside_rig={}, reliable={}, keeps_last={}, depth={}, deadline_s={}),
)",
      topic.path, package, name, truth(topic.global), truth(profile.reliable),
      truth(profile.transient_local), profile.depth,
      topic.rate_hz > 0 ? profile.deadline_periods / topic.rate_hz : 0.0);
}

std::string python_topics() {
  std::string rows;
  std::set<std::string_view> packages;
  for (const qos::Topic& topic : qos::kTopics) {
    const std::string_view package = topic.type.substr(0, topic.type.find('/'));
    packages.insert(package);
    rows += row_text(topic, package, topic.type.substr(topic.type.rfind('/') + 1));
  }
  return fmt::format(
      R"py("""Topics of voxtouch with their types and policies, and its network; written by `voxtouch types --python`."""
from dataclasses import dataclass

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from . import {}

NETWORK = """{}"""
{}
TOPICS = {{row.path: row for row in (
{})}}
)py",
      fmt::join(packages, ", "), qos::kNetworkXml, kCode, rows);
}

int write_types(const std::filesystem::path& folder) {
  const std::filesystem::path package = folder / "voxtouch_types";
  std::error_code error;
  std::filesystem::create_directories(package, error);
  if (error)
    throw std::runtime_error(
        fmt::format("Cannot create folder {}: {}", package.string(), error.message()));
  for (const msg::PythonFile& file : msg::kPythonFiles)
    OutputFile(package / file.name).keep(std::string(file.text));
  OutputFile(package / "topics.py").keep(python_topics());
  console::print_result(
      "Wrote {} for the Python package cyclonedds 11 (PyPI). Its __init__.py has an example of "
      "five lines.\n",
      package.string());
  return 0;
}

}  // namespace

void add_types(CLI::App& app, Action& action) {
  const auto folder = std::make_shared<std::filesystem::path>();
  CLI::App* verb = app.add_subcommand("types");
  verb->add_option("--python", *folder,
                   "Writes DIR/voxtouch_types, a Python package for cyclonedds 11 (PyPI)")
      ->type_name("DIR")
      ->required();
  verb->callback([&action, folder] { action = [folder] { return write_types(*folder); }; });
}

}  // namespace voxtouch::cli

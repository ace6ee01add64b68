#pragma once
/// A run at its end, as values: the nodes' last reports, and the observations of `up`.
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nodes/cli/up/restarts.hpp"
#include "nodes/cli/up/run_limits.hpp"

namespace voxtouch::cli {

using Reports = std::map<std::string, runtime::NodeReport>;  ///< last report of each node

/// A figure of a node's last report; 0 if absent.
double number(const Reports& reports, const std::string& node, const std::string& name);
/// A value of it; empty if absent.
std::string word(const Reports& reports, const std::string& node, const std::string& key);

/// Why a run failed, or what is noted about it.
enum class RunFact : std::uint8_t {
  // Each of these fails the run.
  kNodeEnded,       ///< value: exit status, 128 + signal number
  kNodeFailed,      ///< text: its message
  kNodeSilent,      ///< value: seconds
  kNotRestarted,    ///< text: why
  kCutShort,        ///< value: requested duration [s]
  kNoFinalStatus,   ///< value: samples in its last status
  kDisagree,        ///< value: samples; text: the validator's message
  kForeignSamples,  ///< value: refused samples; text: by which node, of which writers
  kForeignRecords,  ///< value: records refused; text: the logger's message
  kFaultLatched,    ///< value: times
  kTooStiff,        ///< value, bound: displayed and permitted stiffness [N/m]
  kNoSample,
  kNoForce,        ///< text: the device's reason
  kRatioAboveOne,  ///< node: the limit's name; value: the ratio
  kLostRecording,  ///< text: missing parts of the bag
  // From here on notes.
  kInterrupted,      ///< value: samples without force; bound: times; text: the last reason
  kForeignWriters,   ///< text: writers and topics
  kRefusedStatuses,  ///< value: statuses; text: writers
  kChanges,          ///< value: changes made; text: by whom, with counts
  kRecovers,         ///< value: messages; text: the writer
  kSamples,          ///< value: samples; text: their property
  kExternal,         ///< text: the wrench from outside
  kRestarted,    ///< value: samples of the device; text: how the process ended; bound: 1 if it was
                 ///< started again
  kPageEnded,    ///< text: how
  kBagGoesOn,    ///< text: the folder
  kFaultRecord,  ///< text: its cause, and its path
  kStartCheck,   ///< text: result of the check at start for each figure
};
struct Found {
  RunFact what;
  std::string node{};
  double value = 0.0, bound = 0.0;
  std::string text{};
};

/// A participant outside the ring with a writer, present or past, on a topic of the ring.
struct UnauthorisedWriter {
  std::string name;
  std::set<std::string> topics;
  double recovers = 0.0;  ///< its Recover messages
};

/// State of the bag after the run.
struct BagState {
  std::uint64_t messages = 0;
  std::vector<std::string> losses;  ///< sentences of bag::BagReader
};

struct RunRecord {
  std::string scene, device, motion, mode, bag;
  std::uint64_t seed = 0;
  double validate_every = 1.0;
  ChosenLimits limits;
  Reports reports;
  std::set<std::string> started;  ///< nodes
  std::map<std::string, double>
      silence_s;  ///< longest time without a status; of "up": without a poll
  std::vector<Restart> restarts;
  std::vector<Found> events;  ///< seen during the run
  std::vector<UnauthorisedWriter> unauthorised;
  std::vector<std::string> fault_records;  ///< sentences
  std::optional<BagState> recorded;        ///< absent: no bag was made
  double refused_statuses = 0.0;
  std::string refused_writers;  ///< of those statuses
};

/// From reports to the figures that limits are compared with.
RunFigures figures_of(const RunRecord& run);
/// Whether its rendering has a virtual tool.
bool has_virtual_tool(const RunRecord& run);
/// In lockstep time is simulated: there is no latency to measure.
bool measures_latency(const RunRecord& run);

}  // namespace voxtouch::cli

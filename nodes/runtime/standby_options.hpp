#pragma once
/// What a rendering or a coupling is told of a second one of its kind.
#include <cstdint>
#include <string>
#include <vector>

#include "nodes/runtime/failover.hpp"

namespace CLI {
class App;
}

namespace voxtouch::runtime {

/// Whom the acting one takes as its standby. The place belongs to the session: who comes later than
/// kFirstAnswers, where it has been nobody's, is not taken. Where somebody has had it in this
/// session, and has gone, the next one that comes may.
enum class TakesStandby : std::uint8_t { kNever, kFromStart, kAny };
inline constexpr std::uint64_t kFirstAnswers = 1000;

struct StandbyOptions {
  bool is_standby = false;  ///< it answers only where the other one does not
  TakesStandby takes = TakesStandby::kFromStart;
  std::uint64_t unanswered = Failover::kUnanswered;  ///< samples in a row that the other one leaves
                                                     ///< out before this one answers
};

/// --standby, --standby-after, --takes-standby.
void add_standby_options(CLI::App& app, StandbyOptions& options);
/// The command line of a node that gets exactly these options.
void append_arguments(const StandbyOptions& options, std::vector<std::string>& arguments);

/// As they hold: in lockstep, where every sample waits for its answer, nobody stands by. Throws
/// std::runtime_error where one is to.
StandbyOptions in_mode(const StandbyOptions& options, bool lockstep);

/// A node started with --standby: "rendering_standby". That is its name for good, also while it
/// acts.
std::string standby_of(std::string_view role);
inline std::string name_in_ring(const StandbyOptions& options, std::string_view role) {
  return options.is_standby ? standby_of(role) : std::string(role);
}

}  // namespace voxtouch::runtime

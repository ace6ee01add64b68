#include "nodes/runtime/standby_options.hpp"

#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace voxtouch::runtime {
namespace {

const std::map<std::string, TakesStandby> kWords{{"never", TakesStandby::kNever},
                                                 {"start", TakesStandby::kFromStart},
                                                 {"any", TakesStandby::kAny}};

}  // namespace

void add_standby_options(CLI::App& app, StandbyOptions& o) {
  app.add_flag("--standby", o.is_standby,
               "Stand by for another one that is started with the same options: compute every "
               "answer, and answer where it does not");
  app.add_option(
         "--standby-after", o.unanswered,
         "Samples in a row that the other one leaves without an answer before this one takes over")
      ->capture_default_str()
      ->check(CLI::Range(Failover::kUnanswered, std::uint64_t{1000}));
  app.add_option("--takes-standby", o.takes,
                 fmt::format("Which standby this one takes: never, start (one that is there within "
                             "its first {} answers of a session), any",
                             kFirstAnswers))
      ->transform(CLI::CheckedTransformer(kWords))
      ->option_text("never|start|any");
}

void append_arguments(const StandbyOptions& o, std::vector<std::string>& arguments) {
  if (o.is_standby)
    arguments.push_back("--standby");
  if (o.unanswered != Failover::kUnanswered)
    arguments.insert(arguments.end(), {"--standby-after", fmt::to_string(o.unanswered)});
  for (const auto& [word, takes] : kWords)
    if (takes == o.takes && takes != TakesStandby::kFromStart)
      arguments.insert(arguments.end(), {"--takes-standby", word});
}

StandbyOptions in_mode(const StandbyOptions& options, bool lockstep) {
  if (lockstep && options.is_standby)
    throw std::runtime_error(
        "--standby is for real time: in lockstep the device waits for each answer, and a node that "
        "is lost ends the run. Start without --lockstep");
  StandbyOptions own = options;
  if (lockstep)
    own.takes = TakesStandby::kNever;
  return own;
}

std::string standby_of(std::string_view role) { return std::string(role) + "_standby"; }

}  // namespace voxtouch::runtime

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/change_client.hpp"

namespace voxtouch::cli {
namespace {

struct ChangeOptions : runtime::ChangeWords {
  runtime::NodeOptions node;
  bool json = false;
};

int change(const ChangeOptions& o) {
  (void)runtime::read_changes(o);  // before anything of DDS begins
  const bus::Participant participant(o.node.participant("change"));
  nlohmann::ordered_json answers = nlohmann::ordered_json::array();
  const auto answered = [&](const runtime::ChangeAnswer& answer) {
    answers.push_back({{"done", answer.sentence}, {"from_sample", answer.from_sample}});
    if (!o.json)
      console::print_result("{}\n", answer.sentence);
  };
  const std::string problem = runtime::ChangeClient(participant, o.node)
                                  .request(o, answered, [](const std::string& sentence) {
                                    console::log("{}\n", sentence);
                                  });
  if (o.json) {
    nlohmann::ordered_json j{{"ok", problem.empty()},
                             {"answers", answers},
                             {"problems", nlohmann::ordered_json::array()}};
    if (!problem.empty())
      j["problems"].push_back(problem);
    console::print_result("{}\n", j.dump(2));
  } else if (!problem.empty()) {
    console::log("error: {}\n", problem);
  }
  return problem.empty() ? 0 : 1;
}

}  // namespace

void add_change(CLI::App& app, Action& action) {
  auto o = std::make_shared<ChangeOptions>();
  CLI::App* verb = app.add_subcommand("change");
  verb->add_option("WORDS", o->words,
                   "EFFECT on|off, EFFECT gain X, or EFFECT PARAMETER=VALUE[,V,V] ...")
      ->option_text("EFFECT ...");
  verb->add_flag("--reload", o->reload,
                 "Reads the scene file again, builds it in the background and swaps it in");
  verb->add_option("--voxel-size", o->voxel_size_m,
                   "With --reload: voxel edge [m] instead of the file's")
      ->check(runtime::require_positive);
  verb->add_option("--model", o->model, "With --reload: contact model instead of the file's")
      ->check(CLI::IsMember({"original", "adapted", "field"}));
  verb->add_option("--from-sample", o->from_sample,
                   "Sequence number of the first device sample with the change; runs in lockstep "
                   "are then bit-identical.\n"
                   "Refused if that sample has passed. Default: the next sample")
      ->check(runtime::require_whole);
  runtime::add_rig_options(*verb, o->node);
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->callback([o, &action] { action = [o] { return change(*o); }; });
}

}  // namespace voxtouch::cli

#include <memory>

#include <CLI/CLI.hpp>

#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"

namespace voxtouch::cli {
namespace {

int report(Report o) {
  if (o.page.empty()) {
    const std::filesystem::path folder =
        std::filesystem::is_directory(o.bag) ? o.bag : o.bag.parent_path();
    const auto name = std::filesystem::weakly_canonical(o.compared).filename().stem().string();
    o.page =
        folder / (o.compared.empty() ? "report.html" : "report_compared_with_" + name + ".html");
  }
  console::print_result("{}\n", *write_report(o));
  return 0;
}

}  // namespace

void add_report(CLI::App& app, Action& action) {
  auto o = std::make_shared<Report>();
  CLI::App* verb = app.add_subcommand("report");
  verb->add_option("BAG", o->bag, "Folder of a recording")->required()->check(CLI::ExistingPath);
  verb->add_option("--compare-with", o->compared, "Second recording, plotted next to the first")
      ->check(CLI::ExistingPath);
  verb->add_option("--out", o->page,
                   "Page to write (.html); default: report.html in the recording's folder");
  verb->add_option("--rig", o->rig,
                   "Rig, if the recording holds several; default: haptic, or the only one");
  verb->callback([o, &action] { action = [o] { return report(*o); }; });
}

}  // namespace voxtouch::cli

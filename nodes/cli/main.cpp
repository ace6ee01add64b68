#include <array>

#include "nodes/cli/verbs.hpp"

int main(int argc, char** argv) {
  using namespace voxtouch::cli;
  const std::array<AddVerb*, 19> verbs{
      add_up,     add_try,     add_new,    add_build, add_probe,   add_design, add_accuracy,
      add_plan,   add_schema,  add_change, add_types, add_view,    add_report, add_replay,
      add_status, add_recover, add_doctor, add_keys,  add_identify};
  return run(argc, argv, verbs);
}

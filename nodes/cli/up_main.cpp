/// `voxtouch` with the verb `up` alone: deploy/demo builds this one.
#include <array>

#include "nodes/cli/verbs.hpp"

int main(int argc, char** argv) {
  const std::array<voxtouch::cli::AddVerb*, 1> verbs{voxtouch::cli::add_up};
  return voxtouch::cli::run(argc, argv, verbs);
}

// The same under --security: the one that takes over has the certificate of the role, and nobody
// else writes its topic.
#include <gtest/gtest.h>

#include "nodes/security/make_keys.hpp"
#include "tests/attack/failover/expect_taken_over.hpp"

namespace voxtouch::attack {
namespace {

class SecuredFailover : public testing::TestWithParam<const char*> {};

/// DDS takes one set of keys a process and domain.
const std::filesystem::path& keys() {
  static const test::TemporaryFolder folder;
  static const std::filesystem::path made = [] {
    security::make_keys(folder / "keys", "haptic", 30);
    return folder / "keys";
  }();
  return made;
}

TEST_P(SecuredFailover, GoesOnWithoutAStepAndAnswersNoSampleTwice) {
  expect_taken_over({.victim = GetParam(), .keys = keys()});
}

INSTANTIATE_TEST_SUITE_P(Ring, SecuredFailover, testing::Values("rendering", "coupling"),
                         [](const auto& victim) { return std::string(victim.param) + "_killed"; });

}  // namespace
}  // namespace voxtouch::attack

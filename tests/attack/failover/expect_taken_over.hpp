#pragma once
/// What a test asks of a round of failover.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/attack/failover/failover_round.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {

/// Plays it on a domain of the test's own, and tells what came of it.
inline void expect_taken_over(FailoverOptions ask) {
  ask.domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  const FailoverResult r = play(ask);
  std::printf(
      "%.0f periods, %d samples without force, %d sent late, step %.3f N (usual %.3f N, ramp %.3f "
      "N), %llu takeovers; the machine stood still for %.1f ms\n",
      r.takeover_periods, r.unforced, r.sent_late, r.step_n, r.usual_step_n, r.ramp_step_n,
      static_cast<unsigned long long>(r.takeovers), r.machine_ms);
  for (const std::string& fault : r.faults)
    ADD_FAILURE() << fault;
}

}  // namespace voxtouch::attack

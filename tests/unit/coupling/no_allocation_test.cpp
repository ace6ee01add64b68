/// Counts heap allocations, beneath `operator new` too, while a coupling runs.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/coupling/running_coupling.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::coupling {
namespace {

TEST(NoAllocation, StepsResetsAndRedesignsUseNoHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  CouplingSpec spec;
  spec.cutoff_hz = 50;
  spec.stiffness_cap_n_per_m = 300, spec.stiffness_cap_nm_per_rad = 0.1;
  spec.injected_damping_ns_per_m = 4, spec.injected_damping_nms_per_rad = 0.01;
  CouplingSpec other = spec, third = spec;
  other.kind = "spring_damper", third.kind = "direct", third.velocity_window = kMaxVelocityWindow;
  RunningCoupling coupling(spec, {8.5, 0.1}, 1e-3);
  EXPECT_EQ(test::heap_count_of([&] {
              for (int n = 0; n < 3000; ++n) {
                CouplingInput in;
                if (n % 100 > 20) {
                  in.contact = {{4, 0.01 * n, 0}, {0.01, 0, 0}};
                  in.contact_stiffness_n_per_m = 900;
                  in.contact_stiffness = 800 * Mat6::Identity();
                }
                if (n % 17 == 0)
                  in.contact.force.x() = std::nan("");
                in.tool.position.x() = 1e-3 * std::sin(0.05 * n);
                coupling.step(in, n % 41 ? 1e-3 : 1.0);
                if (n % 300 == 299)
                  coupling.reset({{1, 0, 0}, {0, 0, 0}});
                if (n % 100 == 50)
                  coupling.redesign(n % 300 == 50 ? other : n % 300 == 150 ? third : spec);
              }
            }),
            0);
  EXPECT_GT(coupling.counters().capped, 1000U);
}

}  // namespace
}  // namespace voxtouch::coupling

// Row H3: denormal numbers after a release.
#include <gtest/gtest.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <limits>
#include <thread>

#include "nodes/runtime/realtime.hpp"
#include "tests/unit/coupling/haptic_loop.hpp"

namespace voxtouch::test {
namespace {

constexpr double kT = 1e-3;

#if defined(__SSE2__)
constexpr unsigned kDenormalOperand = 0x2, kUnderflow = 0x10;

/// Denormal operands or results during `work`: a step with them takes up to a hundred times as
/// long.
template <class Work>
unsigned denormals_met(const Work& work) {
  _mm_setcsr(_mm_getcsr() & ~(kDenormalOperand | kUnderflow));
  work();
  return _mm_getcsr() & (kDenormalOperand | kUnderflow);
}

TEST(H3Denormals, VanishAMinuteAfterRelease) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"})
    for (const double cutoff_hz : {0.5, 5.0, 50.0}) {
      coupling::CouplingSpec spec;
      spec.kind = kind, spec.cutoff_hz = cutoff_hz, spec.damping_ratio = 1.0;
      spec.stiffness_cap_n_per_m = 800;
      spec.injected_damping_ns_per_m = 5;
      coupling::RunningCoupling coupling(spec, {3.3, 0.1}, kT);
      Vec3 at(0.001, 2e-4, 0);
      for (int n = 0; n < 1000; ++n)
        at.x() -= 4e-6, coupling.step(coupling::wall(at, 1000), kT);
      coupling::CouplingInput away;
      for (int n = 0; n < 60'000; ++n)
        away.tool.position = Vec3(0.01 + 1e-7 * (n % 7), 0, 0), coupling.step(away, kT);
      bool zero = true;
      const unsigned met = denormals_met([&] {
        for (int n = 0; n < 100'000; ++n)
          zero &= coupling.step(away, kT).wrench.zero();
      });
      EXPECT_EQ(met, 0U) << kind << " " << cutoff_hz << " Hz";
      EXPECT_TRUE(zero) << kind << " " << cutoff_hz << " Hz";
    }
}

TEST(H3Denormals, AreSeenByThisTestAndFlushedInTheThreadsOfTheRing) {
  volatile double tiny = std::numeric_limits<double>::min();
  EXPECT_NE(denormals_met([&] { tiny = 0.4 * tiny; }), 0U);
  double halved = 1.0;
  std::thread loop([&] {
    runtime::flush_denormals();
    volatile double small = std::numeric_limits<double>::min();
    small = 0.5 * small;
    halved = small;
  });
  loop.join();
  EXPECT_EQ(halved, 0.0);
}
#endif

}  // namespace
}  // namespace voxtouch::test

/// Counts what is asked of the heap, beneath `operator new` too, while a coupling runs.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/coupling/running_coupling.hpp"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define VOXTOUCH_COUNTS_MALLOC 1
namespace {
thread_local bool counting = false;
thread_local long asked = 0;
}  // namespace
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) {
  asked += counting;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  asked += counting;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  asked += counting;
  return __libc_realloc(old, size);
}
}
#endif

namespace voxtouch {
namespace {

#ifdef VOXTOUCH_COUNTS_MALLOC
template <class Body>
long count(Body body) {
  asked = 0;
  counting = true;
  body();
  counting = false;
  return asked;
}

TEST(NoAllocation, TheCounterSeesNewAndMalloc) {
  EXPECT_GE(count([] { delete new volatile int(1); }), 1);
  EXPECT_GE(count([] { std::string(100, 'x').push_back('y'); }), 1);
}

TEST(NoAllocation, AStepAResetAndACleanRedesignTakeNothingFromTheHeap) {
  CouplingSpec spec;
  spec.cutoff_hz = 50;
  spec.stiffness_cap_n_per_m = 300, spec.stiffness_cap_nm_per_rad = 0.1;
  spec.injected_damping_ns_per_m = 4, spec.injected_damping_nms_per_rad = 0.01;
  spec.passivity_damping_limit_ns_per_m = 5, spec.passivity_damping_limit_nms_per_rad = 0.02;
  CouplingSpec other = spec, third = spec;
  other.kind = "spring_damper", third.kind = "direct";
  RunningCoupling coupling(spec, {8.5, 0.1}, 1e-3);
  EXPECT_EQ(count([&] {
              for (int n = 0; n < 3000; ++n) {
                CouplingInput in;
                if (n % 100 > 20) {
                  in.contact = {{4, 0.01 * n, 0}, {0.01, 0, 0}};
                  in.contact_stiffness_n_per_m = 900;
                  in.contact_stiffness = 800 * Mat6::Identity();
                }
                if (n % 17 == 0) in.contact.force.x() = std::nan("");
                in.tool.position.x() = 1e-3 * std::sin(0.05 * n);
                coupling.step(in, n % 41 ? 1e-3 : 1.0);
                if (n % 300 == 299) coupling.reset({{1, 0, 0}, {0, 0, 0}});
                if (n % 100 == 50) coupling.redesign(n % 300 == 50 ? other : n % 300 == 150 ? third : spec);
              }
            }),
            0);
  EXPECT_GT(coupling.counters().capped, 1000U);
  EXPECT_GT(coupling.counters().controlled, 10U);
}
#else
TEST(NoAllocation, IsNotCountedUnderASanitiser) { GTEST_SKIP() << "the sanitiser owns malloc"; }
#endif

}  // namespace
}  // namespace voxtouch

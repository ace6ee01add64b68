// What acts at the touched point allocates nothing: malloc itself is counted, since operator new would not see Eigen's calls.
#include <atomic>
#include <cstdlib>

#include "tests/unit/effects/touch_support.hpp"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define VOXTOUCH_COUNTS_MALLOC 1
namespace {
std::atomic<std::uint64_t> calls{0};
}
extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t size) { return calls.fetch_add(1), __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return calls.fetch_add(1), __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return calls.fetch_add(1), __libc_realloc(old, size); }
void* aligned_alloc(size_t alignment, size_t size) { return calls.fetch_add(1), __libc_memalign(alignment, size); }
}
#endif

namespace voxtouch::test {
namespace {

TEST(TouchEffects, AllocateNothingInAnyFrame) {
#ifndef VOXTOUCH_COUNTS_MALLOC
  GTEST_SKIP() << "the sanitizer owns malloc";
#else
  EffectChain chain({effect("friction", {{"coulomb", {0.5}}, {"sticking", {1.5}}}),
                     effect("surface_damping", {{"damping_ns_per_m", {3}}}),
                     effect("texture", {{"pattern", {1}}, {"wavelength_m", {0.002}}, {"force_n", {0.3}}})});
  const std::uint64_t at_first = calls;
  std::free(std::malloc(16));
  ASSERT_GT(calls, at_first) << "malloc is not counted";
  double pushed_n = 0.0;
  const std::uint64_t before = calls;
  for (int n = 0; n < 3000; ++n) {
    EffectFrame frame;
    frame.tool = {Vec3(1e-5 * n, 0, 0.011 - 0.002 * std::sin(0.01 * n)),
                  Quat(Eigen::AngleAxisd(1e-4 * n, Vec3::UnitY()))};
    frame.twist.linear = Vec3(0.01, 0, 0), frame.dt_s = 0.001, frame.time_s = 0.001 * n;
    const ContactResult contact = on_plane(frame.tool, BallTool{}, Vec3::UnitZ(), 0, 1000);
    std::array<ObjectContact, 24> touched;  // more than there is room for
    for (std::uint32_t o = 0; o < touched.size(); ++o)
      touched[o] = {(o + static_cast<std::uint32_t>(n) / 100) % 40, &contact, {}};
    frame.contacts = touched;
    pushed_n = std::max(pushed_n, chain.apply(frame).wrench.force.norm());
    if (n % 500 == 499) chain.reset();
  }
  const std::uint64_t after = calls;
  EXPECT_EQ(after, before);
  EXPECT_GT(pushed_n, 1.0);
#endif
}

}  // namespace
}  // namespace voxtouch::test

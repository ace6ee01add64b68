// Rendering allocates nothing: malloc itself is counted, since operator new alone would not see Eigen's own calls.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "field_scenes.hpp"
#include "fixtures.hpp"

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

TEST(ContactRenderer, AllocatesNothingInAnyFrame) {
#ifndef VOXTOUCH_COUNTS_MALLOC
  GTEST_SKIP() << "the sanitizer owns malloc";
#else
  const double e = 0.001;
  const Voxmap voxmap = block({Vec3::Zero(), e}, {0, 0, 0}, {60, 60, 60});
  const Ground ground(box_mesh(Vec3(61, 61, 61) * e, {Vec3(30.5, 30.5, 30.5) * e, Quat::Identity()}), e);
  for (const auto kind : {ContactModelKind::kOriginal, ContactModelKind::kAdapted, ContactModelKind::kClustered,
                          ContactModelKind::kField}) {
    const bool field = kind == ContactModelKind::kField;
    const bool by_area = field || kind == ContactModelKind::kClustered;
    ContactRenderer renderer(field ? ground.voxmap : voxmap, sphere_shell(10 * e, e), kind,
                             {100.0, by_area ? PointWeights::kArea : PointWeights::kOne}, &ground.field);
    const std::uint64_t at_first = calls;
    std::free(std::malloc(16));
    ASSERT_GT(calls, at_first) << "malloc is not counted";
    std::uint32_t most_inside = 0;
    const std::uint64_t before = calls;
    for (int n = 0; n < 2000; ++n) {  // free, touching, gone through, wholly inside, and out again
      const double depth = n < 1000 ? 0.04 * n : 0.04 * (2000 - n);
      Pose pose{e * Vec3(30.1, 29.7, 72.0 - depth), Quat(Eigen::AngleAxisd(0.001 * n, Vec3::UnitX()))};
      if (n % 100 == 99) pose.position.x() = std::numeric_limits<double>::quiet_NaN();
      most_inside = std::max(most_inside, renderer.render(pose).contact.interior_hits);
      renderer.probe(pose);
    }
    renderer.reset();
    const std::uint64_t after = calls;
    EXPECT_EQ(after, before);
    EXPECT_EQ(most_inside, renderer.query().shell().size());  // the longest list of hits there can be
  }
#endif
}

}  // namespace
}  // namespace voxtouch::test

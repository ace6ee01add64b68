// Times of the contact query and of what comes after its hits, by place and number of points, beside reading 12 bytes a point: what
// any query that looks at every point costs at least. Ratios are what counts; deploy/bench writes them down.
#include <benchmark/benchmark.h>

#include <map>
#include <string_view>

#include "core/contact/contact_renderer.hpp"
#include "core/contact/instructions.hpp"
#include "tests/bench/bench_scene.hpp"

namespace voxtouch::bench {
namespace {

const voxmap::Voxmap& ground() {
  static const voxmap::Voxmap map = cup();
  return map;
}

void count(benchmark::State& state, std::size_t points, double tested, double hits) {
  const auto frames = static_cast<double>(state.iterations());
  state.counters["ns/point"] = benchmark::Counter(static_cast<double>(points) * 1e-9 * frames,
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["tested%"] = 100.0 * tested / frames / static_cast<double>(points);
  state.counters["hits%"] = 100.0 * hits / frames / static_cast<double>(points);
}

/// Four vectors of sums, so that no addition waits for the one before: as fast as memory gives the numbers.
using Floats = float __attribute__((vector_size(16)));
float add_up(const std::vector<float>& values) {
  Floats sums[4] = {};
  for (std::size_t n = 0; n + 16 <= values.size(); n += 16)
    for (std::size_t k = 0; k < 4; ++k) {
      Floats four;
      __builtin_memcpy(&four, values.data() + n + 4 * k, sizeof four);
      sums[k] += four;
    }
  const Floats all = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  return (all[0] + all[1]) + (all[2] + all[3]);
}

void read_12_bytes(benchmark::State& state, std::size_t points) {
  const std::vector<float> x(points, 1.0F), y(points, 2.0F), z(points, 3.0F);
  for (auto _ : state) {
    float sum = 0.0F;
    for (const std::vector<float>* const axis : {&x, &y, &z}) sum += add_up(*axis);
    benchmark::DoNotOptimize(sum);
  }
  count(state, points, 0.0, 0.0);
}

void find(benchmark::State& state, Place place, std::size_t points) {
  const contact::ContactQuery query(ground(), tool(place, points));
  const std::vector<Pose> poses = path(place);
  contact::HitList hits;
  hits.reserve(points);
  double tested = 0.0, hit = 0.0;
  std::size_t n = 0;
  for (auto _ : state) {
    query.find(poses[n++ % poses.size()], hits);
    tested += hits.tested, hit += static_cast<double>(hits.surface.size() + hits.interior.size());
  }
  count(state, points, tested, hit);
}

void render(benchmark::State& state, Place place, std::size_t points, contact::ContactModelKind model) {
  contact::ContactRenderer renderer(ground(), tool(place, points), model, {1.0, contact::PointWeights::kArea});
  const std::vector<Pose> poses = path(place);
  double tested = 0.0, hit = 0.0;
  std::size_t n = 0;
  for (auto _ : state) {
    const contact::ContactResult contact = renderer.render(poses[n++ % poses.size()]).contact;
    tested += contact.points_tested, hit += contact.surface_hits + contact.interior_hits;
  }
  count(state, points, tested, hit);
}

void add_all() {
  for (const std::size_t points : {1000U, 10'000U, 100'000U, 1'000'000U}) {
    const std::string size = "/" + std::to_string(points);
    benchmark::RegisterBenchmark(("read 12 bytes a point" + size).c_str(), read_12_bytes, points);
    for (const Place place : {Place::kFar, Place::kNear, Place::kLight, Place::kHeavy}) {
      const std::string row = "/" + name_of(place) + size;
      benchmark::RegisterBenchmark(("find" + row).c_str(), find, place, points);
      for (const auto model :
           {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted, contact::ContactModelKind::kClustered})
        benchmark::RegisterBenchmark(("render " + std::string(contact::name_of(model)) + row).c_str(), render, place, points, model);
    }
  }
}

}  // namespace
}  // namespace voxtouch::bench

int main(int argc, char** argv) {
  // The kernels of a lesser processor than this one: --instructions=any, avx2, avx512.
  using voxtouch::contact::Instructions;
  const std::map<std::string_view, Instructions> kinds = {
      {"--instructions=any", Instructions::kAny}, {"--instructions=avx2", Instructions::kAvx2}, {"--instructions=avx512", Instructions::kAvx512}};
  if (const auto kind = argc > 1 ? kinds.find(argv[1]) : kinds.end(); kind != kinds.end()) {
    voxtouch::contact::use_instructions(kind->second);
    argv[1] = argv[0], ++argv, --argc;
  }
  benchmark::AddCustomContext("instructions", std::to_string(static_cast<int>(voxtouch::contact::instructions())));
  voxtouch::bench::add_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

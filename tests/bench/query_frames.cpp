// Frames of the contact query for callgrind to count: `query_frames PLACE POINTS FRAMES
// find|MODEL`. Counted is `counted_frame` alone.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/contact/contact_renderer.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "tests/bench/bench_mesh.hpp"

extern "C" __attribute__((noinline)) void counted_frame(const std::function<void()>& frame) {
  frame();
}

int main(int argc, char** argv) {
  using namespace voxtouch;
  if (argc != 5)
    return 2;
  bench::Place place = bench::Place::kFar;
  for (const auto each : {bench::Place::kNear, bench::Place::kLight, bench::Place::kHeavy})
    if (bench::name_of(each) == argv[1])
      place = each;
  const auto points = static_cast<std::size_t>(std::atol(argv[2]));
  const bool find = std::string(argv[4]) == "find";
  auto model = contact::ContactModelKind::kAdapted;
  if (!find && !contact::parse_contact_model(argv[4], model))
    return 2;
  const bool with_distances =
      model == contact::ContactModelKind::kField;  // of a mesh, so its cup has other voxels
  const mesh::TriangleMesh mesh = with_distances ? bench::cup_mesh(5'000) : mesh::TriangleMesh();
  const voxmap::Voxmap map =
      with_distances ? voxmap::voxelise(mesh, {bench::kEdge * Vec3(0.06, 0.08, 0.1), bench::kEdge},
                                        serial_for())
                     : bench::cup();
  const voxmap::DistanceField field =
      with_distances ? voxmap::build_distance_field(mesh, map, {}, serial_for())
                     : voxmap::DistanceField();
  contact::ContactRenderer renderer(map, bench::tool(place, points), model,
                                    {1.0, contact::PointWeights::kArea}, &field);
  contact::HitList hits;
  hits.reserve(points);
  const std::vector<Pose> poses = bench::path(place);
  double tested = 0.0;
  const int frames = std::atoi(argv[3]);
  for (int n = 0; n < frames; ++n)
    counted_frame([&] {
      const Pose& pose = poses[static_cast<std::size_t>(n) % poses.size()];
      if (find)
        renderer.query().find(pose, hits), tested += hits.tested;
      else
        tested += renderer.render(pose).contact.points_tested;
    });
  std::printf("%.0f\n", tested / frames);
  return 0;
}

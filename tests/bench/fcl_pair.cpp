#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "tests/bench/others.hpp"

namespace voxtouch::bench {
namespace {

using Bvh = fcl::BVHModel<fcl::OBBRSSd>;

std::unique_ptr<Bvh> make_bvh(const mesh::TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto bvh = std::make_unique<Bvh>();
  bvh->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  bvh->addSubModel(mesh.vertices, triangles);
  bvh->endModel();
  return bvh;
}

class FclPair final : public OtherPair {
 public:
  FclPair(const mesh::TriangleMesh& still, const mesh::TriangleMesh& moving, FclQuestion question)
      : still_(make_bvh(still)), moving_(make_bvh(moving)), question_(question) {}

  double ask(const Pose& pose) override {
    fcl::Transform3d at = fcl::Transform3d::Identity();
    at.linear() = pose.orientation.toRotationMatrix(), at.translation() = pose.position;
    const fcl::Transform3d here = fcl::Transform3d::Identity();
    if (question_ == FclQuestion::kDistance) {
      fcl::DistanceResultd result;
      return fcl::distance(still_.get(), here, moving_.get(), at, fcl::DistanceRequestd(true), result);
    }
    const bool all = question_ == FclQuestion::kAllContacts;
    constexpr std::size_t kAll = 100'000'000;
    fcl::CollisionResultd result;
    fcl::collide(still_.get(), here, moving_.get(), at, fcl::CollisionRequestd(all ? kAll : 1, all), result);
    return static_cast<double>(result.numContacts());
  }

 private:
  std::unique_ptr<Bvh> still_, moving_;
  FclQuestion question_;
};

}  // namespace

std::unique_ptr<OtherPair> fcl_pair(const mesh::TriangleMesh& still, const mesh::TriangleMesh& moving, FclQuestion question) {
  return std::make_unique<FclPair>(still, moving, question);
}

}  // namespace voxtouch::bench

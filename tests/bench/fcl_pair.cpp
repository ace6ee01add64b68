#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "core/reference/fcl_mesh.hpp"
#include "tests/bench/others.hpp"

namespace voxtouch::bench {
namespace {

class FclPair final : public OtherPair {
 public:
  FclPair(const mesh::TriangleMesh& still, const mesh::TriangleMesh& moving, FclQuestion question)
      : still_(reference::make_fcl_mesh(still)),
        moving_(reference::make_fcl_mesh(moving)),
        question_(question) {}

  double ask(const Pose& pose) override {
    fcl::Transform3d at = fcl::Transform3d::Identity();
    at.linear() = pose.orientation.toRotationMatrix(), at.translation() = pose.position;
    const fcl::Transform3d here = fcl::Transform3d::Identity();
    if (question_ == FclQuestion::kDistance) {
      fcl::DistanceResultd result;
      return fcl::distance(still_.get(), here, moving_.get(), at, fcl::DistanceRequestd(true),
                           result);
    }
    const bool all = question_ == FclQuestion::kAllContacts;
    constexpr std::size_t kAll = 100'000'000;
    fcl::CollisionResultd result;
    fcl::collide(still_.get(), here, moving_.get(), at, fcl::CollisionRequestd(all ? kAll : 1, all),
                 result);
    return static_cast<double>(result.numContacts());
  }

 private:
  std::unique_ptr<reference::FclMesh> still_, moving_;
  FclQuestion question_;
};

}  // namespace

std::unique_ptr<OtherPair> fcl_pair(const mesh::TriangleMesh& still,
                                    const mesh::TriangleMesh& moving, FclQuestion question) {
  return std::make_unique<FclPair>(still, moving, question);
}

}  // namespace voxtouch::bench

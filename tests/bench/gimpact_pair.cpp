#include "tests/bench/others.hpp"

#if VOXTOUCH_BULLET
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>
#endif

namespace voxtouch::bench {

#if VOXTOUCH_BULLET
namespace {

constexpr double kMillimetres =
    1e3;  // single precision, with absolute tolerances below 1e-4 of a unit

/// The mesh in Bullet's arrays, which its shapes refer to.
class Shape {
 public:
  explicit Shape(const mesh::TriangleMesh& mesh) {
    for (const Vec3& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis)
        vertices_.push_back(static_cast<btScalar>(kMillimetres * v[axis]));
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t corner : t)
        corners_.push_back(static_cast<int>(corner));
    arrays_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), corners_.data(), 3 * static_cast<int>(sizeof(int)),
        static_cast<int>(mesh.vertices.size()), vertices_.data(),
        3 * static_cast<int>(sizeof(btScalar)));
    shape_ = std::make_unique<btGImpactMeshShape>(arrays_.get());
    shape_->setMargin(0);
    shape_->updateBound();
    object_.setCollisionShape(shape_.get());
  }
  btCollisionObject& object() { return object_; }

 private:
  std::vector<btScalar> vertices_;
  std::vector<int> corners_;
  std::unique_ptr<btTriangleIndexVertexArray> arrays_;
  std::unique_ptr<btGImpactMeshShape> shape_;
  btCollisionObject object_;
};

/// All contacts, also those beyond the four that a manifold keeps.
struct Counted final : btManifoldResult {
  using btManifoldResult::btManifoldResult;
  void addContactPoint(const btVector3&, const btVector3&, btScalar) override { ++contacts; }
  double contacts = 0.0;
};

class GImpactPair final : public OtherPair {
 public:
  GImpactPair(const mesh::TriangleMesh& still, const mesh::TriangleMesh& moving)
      : dispatcher_(&configuration_),
        still_(still),
        moving_(moving) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
  }
  double ask(const Pose& pose) override {
    const Vec3 at = kMillimetres * pose.position;
    const Quat& q = pose.orientation;
    btCollisionObject &still = still_.object(), &moving = moving_.object();
    moving.setWorldTransform(btTransform(
        btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())),
        btVector3(btScalar(at.x()), btScalar(at.y()), btScalar(at.z()))));
    const btCollisionObjectWrapper a(nullptr, still.getCollisionShape(), &still,
                                     still.getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper b(nullptr, moving.getCollisionShape(), &moving,
                                     moving.getWorldTransform(), -1, -1);
    btCollisionAlgorithm* const algorithm =
        dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    Counted counted(&a, &b);
    algorithm->processCollision(&a, &b, btDispatcherInfo(), &counted);
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return counted.contacts;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  Shape still_, moving_;
};

}  // namespace

std::unique_ptr<OtherPair> gimpact_pair(const mesh::TriangleMesh& still,
                                        const mesh::TriangleMesh& moving) {
  return std::make_unique<GImpactPair>(still, moving);
}
#else
std::unique_ptr<OtherPair> gimpact_pair(const mesh::TriangleMesh&, const mesh::TriangleMesh&) {
  return nullptr;
}
#endif

}  // namespace voxtouch::bench

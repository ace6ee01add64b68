#pragma once
/// Whether the tool may start at a pose: free of the object's surface, and neither inside the
/// other.
#include <cstdint>

#include "core/exact/bodies.hpp"
#include "core/exact/posed_points.hpp"

namespace voxtouch::exact {

enum class StartVerdict : std::uint8_t { kPending, kFree, kBlocked };

/// One tool, one object, one pose. The check may be spread over frames: it goes on where its work
/// ended.
class StartCheck {
 public:
  /// Begins anew. Real-time safe.
  void restart() noexcept { next_face_ = next_tool_part_ = next_object_part_ = 0; }

  /// Goes on until the limit of work; `posed` must be the same pose since `restart`. Edges of each
  /// against faces of the other; then one vertex of each part against the other's closed parts, by
  /// winding number. Real-time safe.
  StartVerdict advance(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
                       Work& work) noexcept;

 private:
  std::uint32_t next_face_ = 0, next_tool_part_ = 0, next_object_part_ = 0;
};

/// Whether some edge of either meets a face of the other. Not limited. Real-time safe.
bool intersect(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed) noexcept;

/// Whether `point` is inside a closed part, in the mesh's frame: by the windings along three rays,
/// of which two decide. Inside a part that is turned inside out is outside. Real-time safe.
bool inside_closed_part(const Vec3& point, const FeatureMesh& mesh, const BoxTree& faces,
                        Work& work) noexcept;

}  // namespace voxtouch::exact

#pragma once
/// What keeps the virtual tool out of the static scene: one linear constraint a shell point near
/// it, from the signed distance.
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/contact_query.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// gap + jacobian . delta >= 0 for a step delta = [shift; lever * turn] of the tool, all in metres.
struct ConstraintRow {
  Vec6 jacobian = Vec6::Zero();  ///< [u ; arm x u / lever]
  Vec3 arm = Vec3::Zero();       ///< from the tool's origin to the point, W axes [m]
  double gap_m = 0.0;            ///< below zero: so deep is the point inside
  std::uint32_t point = 0;       ///< index into the shell
  std::uint32_t object = 0;      ///< whose wall it is
  bool of_face =
      false;  ///< of a thin wall's own face or of an edge point, not of the static object's field

  Vec3 normal() const noexcept {
    return jacobian.head<3>();
  }  ///< u: unit, out of the static object, W
};

/// What all rows of one object share.
struct RowFrame {
  Vec3 local = Vec3::Zero();  ///< tool's origin less the grid's and the object's displacement [m]
  double lever_m = 1.0;
  std::uint32_t object = 0;
};

/// The rows of all hits, in their order, added to `rows`, which must have room for them; none of a
/// hit where the field has no direction, or whose gap is so wide that no step can close it.
///
/// As a rule u = g / |g|, gap = distance / |g| of the field: along the point's own normal the tool
/// would stick on its own facets. A wall of a voxel or two bends the field: there, in surface
/// voxels, u and gap are those of the wall's face on the side that the point's own normal names
/// (wall_faces.hpp). Where tool and wall are both thinner than a voxel, the tool's far side names
/// the wrong face. Real-time safe.
void add_rows(const Hits& hits, bool in_surface, const voxmap::DistanceField& field,
              const RowFrame& frame, std::vector<ConstraintRow>& rows) noexcept;

/// The rows with the roles swapped: points of the object's sharp edges and rims
/// (core/pointshell/edge_points.hpp), as `edges` found them in the tool, whose distance is
/// `tool`'s. A row's normal is against the tool's gradient there, and its point is the edge's;
/// `smooth`: as `smooth_normals` has it. None where the gradient does not lead into the object at
/// the edge, on the far side of a thin part of the tool (limits::kEdgeAgree). `frame` and
/// `orientation` are the tool's; `rows` must have room. Real-time safe.
void add_edge_rows(const HitList& hits, const ContactQuery& edges,
                   const voxmap::DistanceField& tool, bool smooth, const RowFrame& frame,
                   const Quat& orientation, std::vector<ConstraintRow>& rows) noexcept;

/// Of the rows of `frame`'s object that are about to push (limits::kSmoothGapEdges) and whose plane
/// is the field's, the normal becomes that of the gradient which does not jump from voxel to voxel,
/// where that is no shorter than next to an even surface (limits::kSmoothGradient). Gaps stay.
/// Real-time safe.
void smooth_normals(const voxmap::DistanceField& field, const RowFrame& frame,
                    std::span<ConstraintRow> rows) noexcept;

/// Leaves at most kMaxRows of them. Of the rows in each of 42 directions (direction_bins.hpp) the
/// one of least gap stays, and those that a tilt of `tilt` [rad] towards one of eight sides would
/// bring deepest: the corners of a flat contact, however many points it has. Linear in the rows;
/// their order stays. Real-time safe.
void keep_nearest(std::vector<ConstraintRow>& rows, double tilt) noexcept;

}  // namespace voxtouch::contact

#pragma once
/// Constraints that keep the virtual tool out of the static scene: one linear row for each nearby
/// shell point, from the signed distance.
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/contact_query.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Constraint on a step delta = [shift; lever * turn] of the tool, all in metres:
///     gap + jacobian . delta >= 0
struct ConstraintRow {
  Vec6 jacobian = Vec6::Zero();  ///< [u ; arm x u / lever]
  Vec3 arm = Vec3::Zero();       ///< from the tool's origin to the point, W axes [m]
  double gap_m = 0.0;            ///< negative: depth of the point inside
  std::uint32_t point = 0;       ///< index into the shell
  std::uint32_t object = 0;      ///< object of the wall
  bool of_face = false;  ///< From the face of a thin wall or from an edge point, not from the field
                         ///< of the static object.

  Vec3 normal() const noexcept {
    return jacobian.head<3>();
  }  ///< u: unit vector out of the static object, W
};

/// Common data of all rows of one object.
struct RowFrame {
  /// Tool's origin minus the grid's and the object's displacement [m].
  Vec3 local = Vec3::Zero();
  double lever_m = 1.0;
  std::uint32_t object = 0;
};

/// Appends the rows of all hits, in their order, to `rows`, which must have room. Real-time safe.
/// A hit gives no row if the field has no direction there, or if the gap is too wide for a step to
/// close. Normally u = g / |g| and gap = distance / |g| of the field; along the point's own normal
/// the tool would stick on its facets. A wall of one or two voxels bends the field. There, in
/// surface voxels, u and gap are those of the wall's face on the side given by the point's normal
/// (wall_faces.hpp). If tool and wall are both thinner than a voxel, points on the far side of the
/// tool select the wrong face.
void add_rows(const Hits& hits, bool in_surface, const voxmap::DistanceField& field,
              const RowFrame& frame, std::vector<ConstraintRow>& rows) noexcept;

/// Appends the rows with swapped roles: points of the object's sharp edges and rims
/// (core/pointshell/edge_points.hpp) in the distance field `tool` of the tool. Real-time safe;
/// `rows` must have room.
/// `edges` is the query that found `hits`. The normal of a row is against the tool's gradient
/// there, and its point is that of the edge. `smooth` selects the gradient of `smooth_normals`.
/// There is no row if the gradient does not lead into the object at the edge, on the far side of a
/// thin part of the tool (limits::kEdgeAgree). `frame` and `orientation` are those of the tool.
void add_edge_rows(const HitList& hits, const ContactQuery& edges,
                   const voxmap::DistanceField& tool, bool smooth, const RowFrame& frame,
                   const Quat& orientation, std::vector<ConstraintRow>& rows) noexcept;

/// Smooths the normals of rows of `frame`'s object that are about to exert a force
/// (limits::kSmoothGapEdges) and whose plane is that of the field. Real-time safe.
/// The new normal is that of the gradient without jumps between voxels, if that is as long as near
/// an even surface (limits::kSmoothGradient). Gaps do not change.
void smooth_normals(const voxmap::DistanceField& field, const RowFrame& frame,
                    std::span<ConstraintRow> rows) noexcept;

/// Reduces the rows to at most kMaxRows, in linear time, and keeps their order. Real-time safe.
/// In each of 42 directions (direction_bins.hpp) it keeps the row of least gap. It also keeps the
/// rows that a tilt of `tilt` [rad] towards one of eight sides would make deepest. These are the
/// corners of a flat contact with any number of points.
void keep_nearest(std::vector<ConstraintRow>& rows, double tilt) noexcept;

}  // namespace voxtouch::contact

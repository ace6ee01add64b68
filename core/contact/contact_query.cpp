#include "core/contact/contact_query.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/contact/limits.hpp"
#include "core/contact/packed_normals.hpp"
#include "core/contact/query_kernel.hpp"

namespace voxtouch::contact {
namespace {

void check(const pointshell::Pointshell& shell) {
  const std::size_t n = shell.size();
  if (shell.y.size() != n || shell.z.size() != n || shell.nx.size() != n || shell.ny.size() != n ||
      shell.nz.size() != n || shell.id.size() != n)
    throw std::invalid_argument(
        "contact: the pointshell's arrays differ in length; build it with core/pointshell");
  for (std::size_t p = 0; p < n; ++p)
    if (!shell.point(p).allFinite() || !shell.normal(p).allFinite())
      throw std::invalid_argument("contact: point " + std::to_string(shell.id[p]) +
                                  " of the pointshell is not finite; check its mesh");
}

void check_areas(const pointshell::Pointshell& shell) {
  if (shell.area_m2.size() != shell.size())
    throw std::invalid_argument("contact: the pointshell has no areas; build it again");
  for (std::size_t p = 0; p < shell.size(); ++p)
    if (!std::isfinite(shell.area_m2[p]) || shell.area_m2[p] < 0.0)
      throw std::invalid_argument("contact: the area of point " + std::to_string(shell.id[p]) +
                                  " of the pointshell is not a number >= 0; check its mesh");
}

/// Converts to single precision, padded to a whole leaf of the tree.
std::vector<float> rounded(const std::vector<double>& values) {
  std::vector<float> out(values.begin(), values.end());
  out.resize((out.size() + SphereTree::kLeafPoints - 1) / SphereTree::kLeafPoints *
             SphereTree::kLeafPoints);
  return out;
}

}  // namespace

ContactQuery::ContactQuery(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
                           PointWeights weights)
    : voxmap_(voxmap),
      shell_(std::move(shell)) {
  check(shell_);
  if (weights == PointWeights::kArea)
    check_areas(shell_);
  tree_ = SphereTree(shell_);
  x_ = rounded(shell_.x), y_ = rounded(shell_.y), z_ = rounded(shell_.z);
  packed_normals_ = packed_normals::all_packed(shell_.nx, shell_.ny, shell_.nz);
  for (std::size_t p = 0; p < shell_.size(); ++p)
    reach_m_ = std::max(reach_m_, shell_.point(p).norm());
  source_.edge = voxmap.grid().edge;
  source_.place[0] = shell_.x.data(), source_.place[1] = shell_.y.data(),
  source_.place[2] = shell_.z.data();
  source_.normal[0] = shell_.nx.data(), source_.normal[1] = shell_.ny.data(),
  source_.normal[2] = shell_.nz.data();
  if (weights == PointWeights::kArea)
    source_.area = shell_.area_m2.data();
  source_.rough.place[0] = x_.data(), source_.rough.place[1] = y_.data(),
  source_.rough.place[2] = z_.data();
  if (!packed_normals_.empty())
    source_.rough.normal = packed_normals_.data();
}

void ContactQuery::find(const Pose& pose_WT, HitList& hits) const noexcept {
  hits.clear();
  Quat orientation = pose_WT.orientation;
  if (!pose_WT.position.allFinite() ||
      !normalise_within(orientation, limits::kMinQuaternionNorm, limits::kMaxQuaternionNorm)) {
    hits.pose_status = PoseStatus::kNotAPose;
    return;
  }
  hits.pose_WT = {pose_WT.position, orientation};
  const voxmap::Grid& grid = voxmap_.grid();
  const Vec3 local = pose_WT.position - grid.origin;
  const double reach_voxels = reach_m_ / grid.edge;
  if (!(local.cwiseAbs().maxCoeff() / grid.edge + reach_voxels < limits::kMaxGridCoordinate)) {
    hits.pose_status = PoseStatus::kOutOfRange;
    return;
  }
  HitSource source = source_;
  const Mat3 rotation = orientation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      source.r[row][column] = rotation(row, column);
    source.t[row] = local[row];
  }
  QueryFrame frame;
  if (!make_query_frame(voxmap_, source, reach_m_, frame))
    return;
  for (int row = 0; row < 3; ++row) {
    std::copy_n(frame.a[row], 3, source.rough.a[row]);
    source.rough.shift[row] = frame.shift[row];
  }
  source.rough.certain = frame.certain;
  FoundHits surface{hits.surface.room(shell_.size())}, interior{hits.interior.room(shell_.size())};
  const QueryData data{&voxmap_, shell_.size(), &tree_, x_.data(), y_.data(), z_.data()};
  hits.tested = search(data, frame, surface, interior);
  hits.surface.keep(surface.count, source);
  hits.interior.keep(interior.count, source);
  hits.surface.set_sums(surface.normals, surface.weights);
  hits.interior.set_sums(interior.normals, interior.weights);
}

}  // namespace voxtouch::contact

#include "core/coupling/stiffness_cap.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace voxtouch::coupling {
namespace {

/// Inverse of a cap; the upper end only keeps a cap that is next to nothing from overflowing.
double per(double cap) noexcept { return std::min(1.0 / cap, 1e100); }

double ramp_s(const CouplingSpec& spec) noexcept {
  return ramp_behind_filter_s(
      spec.kind == name_of(CouplingKind::kShapingFilter) ? cutoff_rad_per_s(spec) : 0.0);
}

/// A wrench below this is none: a share of it could not be told.
constexpr double kNoWrench = 1e-200;

/// The length of the part of `way` across `normal`, which has length one.
double across(const Vec3& way, const Vec3& normal) noexcept {
  return (way - normal.dot(way) * normal).norm();
}

/// Of the wrench `along` over `way` [J for N and Nm].
double work_on(const Vec6& along, const ToolStep& way) noexcept {
  return along.head<3>().dot(way.shift) + along.tail<3>().dot(way.turn);
}

/// Fixed size: Eigen keeps it on the stack, and its iteration is bounded.
template <class Matrix>
double largest(const Matrix& matrix) noexcept {
  const Matrix symmetric = 0.5 * (matrix + matrix.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric, Eigen::EigenvaluesOnly);
  // The Frobenius norm is never less than the largest eigenvalue: what is left if the iteration
  // should not end.
  const double value =
      solver.info() == Eigen::Success ? solver.eigenvalues().maxCoeff() : symmetric.norm();
  return std::max(value, 0.0);
}

}  // namespace

double largest_eigenvalue(const Mat3& matrix) noexcept { return largest(matrix); }
double largest_eigenvalue(const Mat6& matrix) noexcept { return largest(matrix); }

double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept {
  if (!(per_cap_t > 0.0) && !(per_cap_r > 0.0))
    return 1.0;
  double excess = 0.0;  // the stiffness in units of its caps
  if (stiffness.isZero(0.0)) {
    excess = bound * per_cap_t;
  } else if (per_cap_r > 0.0) {
    const double t = std::sqrt(per_cap_t), r = std::sqrt(per_cap_r);
    const Vec6 n = (Vec6() << t, t, t, r, r, r).finished();
    excess = largest_eigenvalue(Mat6(n.asDiagonal() * stiffness * n.asDiagonal()));
  } else {
    excess = per_cap_t * largest_eigenvalue(Mat3(stiffness.topLeftCorner<3, 3>()));
  }
  if (!std::isfinite(excess))
    return 0.0;
  return excess > 1.0 ? 1.0 / excess : 1.0;
}

double share_across(const Mat6& stiffness, const Vec6& along, double s) noexcept {
  // With A = [a b'; b C] along and across: (kCapAcross - s a) (kCapAcross - share |C|) >= ((s +
  // share) |b| / 2)^2. |C| by its Frobenius norm.
  const Vec6 row = stiffness * along;
  const double a = along.dot(row), b2 = std::max(0.0, row.squaredNorm() - a * a);
  const double c =
      std::sqrt(std::max(0.0, stiffness.squaredNorm() - 2.0 * row.squaredNorm() + a * a));
  const double left = std::max(0.0, kCapAcross - s * a), quarter = 0.25 * b2;
  const double room = kCapAcross * left - quarter * s * s, half = 2.0 * quarter * s + left * c;
  if (!(room > 0.0))
    return s;
  const double below = half + std::sqrt(half * half + 4.0 * quarter * room);
  return below > 0.0 ? std::max(s, 2.0 * room / below) : std::numeric_limits<double>::infinity();
}

StiffnessCap::StiffnessCap(const CouplingSpec& spec) noexcept
    : rise_s_(ramp_s(spec)),
      per_cap_t_(per(spec.stiffness_cap_n_per_m)),
      per_cap_r_(per(spec.stiffness_cap_nm_per_rad)) {}

void StiffnessCap::redesign(const CouplingSpec& spec) noexcept {
  rise_s_ = ramp_s(spec);
  per_cap_t_ = per(spec.stiffness_cap_n_per_m);
  per_cap_r_ = per(spec.stiffness_cap_nm_per_rad);
  redesigned_ = units_changed_ = true;
}

/// A contact in units of the caps.
struct StiffnessCap::Push {
  explicit Push(const CouplingInput& input, double per_cap_t, double per_cap_r) noexcept {
    const double t = std::sqrt(per_cap_t), r = std::sqrt(per_cap_r),
                 force = input.contact.force.stableNorm();
    n << t, t, t, r, r, r;
    along << input.contact.force, input.contact.torque;
    w = n.cwiseProduct(along).stableNorm();
    pushes = w > kNoWrench && force > kNoWrench;
    if (!pushes)
      return;
    along /= w, normal = input.contact.force / force,
                per_way = input.contact_stiffness * n.cwiseProduct(n.cwiseProduct(along));
  }
  /// Of length one in units of the caps.
  Vec6 direction(const Vec6& wrench) const noexcept {
    const double length = n.cwiseProduct(wrench).stableNorm();
    return length > kNoWrench ? Vec6(wrench / length) : along;
  }
  Vec6 n;                       ///< diagonal of N
  double w = 0.0;               ///< |N W|
  bool pushes = false;          ///< what is below is known
  Vec6 along;                   ///< W / w
  Vec3 normal = Vec3::Zero();   ///< of the force
  Vec6 per_way = Vec6::Zero();  ///< by how much w grows for a metre and a radian
};

CapShares StiffnessCap::step(const CouplingInput& input, const ToolStep& way,
                             double dt_s) noexcept {
  const double s = step_scale(input, dt_s), depth = input.contact_depth_m;
  const Push push(input, per_cap_t_, per_cap_r_);
  const bool went_on = std::exchange(known_, true);
  if (push.pushes)
    follow(push, way, went_on && size_ > kNoWrench);
  if (units_changed_)
    change_units(push.w);
  const double more = push.w - std::exchange(size_, push.w), least = s * push.w;
  by_depth_ *= std::max(0.0, 1.0 - dt_s / kDefaultRampS);
  if (!(s < 1.0) || !push.pushes) {
    given_ = least, depth_m_ = depth, beside_ = 0.0,
    stored_j_ = std::min(stored_j_, 0.5 * given_ * given_);
    if (depth > 0.0)
      by_depth_ = std::max(by_depth_, least);
    return {s, s, {}};
  }
  given_ = went_on ? given_ + growth(push, input, way, more) : least;
  if (depth > 0.0) {
    by_depth_ = std::max(by_depth_, s * push.per_way.head<3>().dot(push.normal) * depth);
    if (input.depth_goes_on)
      by_depth_ = std::max(by_depth_, given_);
  }
  depth_m_ = depth;
  given_ = std::clamp(given_, least, std::max(least, std::min(push.w, by_depth_)));

  const Mat6 in_caps = push.n.asDiagonal() * input.contact_stiffness * push.n.asDiagonal();
  const double most = std::max(least, push.w * share_across(in_caps / std::max(1.0, over_.now()),
                                                            push.n.cwiseProduct(push.along), s));
  const double with_wrench = split(push, least, most, way, dt_s);
  CapShares shares{given_ > least ? with_wrench / push.w : s, s, {}};
  if (beside_ > 0.0)
    shares.beside = {beside_ * along_.head<3>(), beside_ * along_.tail<3>()};
  return shares;
}

double StiffnessCap::step_scale(const CouplingInput& input, double dt_s) noexcept {
  double allowed =
      cap_scale(input.contact_stiffness, input.contact_stiffness_n_per_m, per_cap_t_, per_cap_r_);
  if (redesigned_) {
    over_ = Ramp(allowed > 0.0 ? std::clamp(scale_ / allowed, 0.0, 1e12) : 1.0);
    over_.head_for(1.0, std::max(rise_s_, kDefaultRampS));
    redesigned_ = false;
  }
  const double before = over_.now(), now = over_.advance(dt_s);
  if (now < before)
    given_ *= now / before,
        by_depth_ *= now / before;  // caps that are lowered take back what they gave
  allowed_ = std::min(allowed * now, 1.0);
  scale_ = std::min(allowed_, scale_ + allowed_ * dt_s / rise_s_);
  return scale_;
}

/// The same shares in the new units. What has changed meanwhile counts as no growth.
void StiffnessCap::change_units(double w) noexcept {
  const double factor = size_ > kNoWrench ? w / size_ : 0.0;
  given_ *= factor, by_depth_ *= factor, size_ = w;
  units_changed_ = false;
}

/// Where the push goes on, and what the hand has put in against it. What is given beside turns
/// towards the contact's push as the hand slides; where that stands against the hand (in a hollow)
/// no more than kCapAcross leaves.
void StiffnessCap::follow(const Push& push, const ToolStep& way, bool went_on) noexcept {
  if (!went_on) {
    along_ = push.along, stored_j_ = 0.0, turning_ = 1.0;
    return;
  }
  stored_j_ -= given_ * work_on(along_, way);
  const double followed =
      std::min(1.0, across(way.shift, push.normal) / kTurnWayM + way.turn.norm() / kTurnRad);
  Vec6 turned = followed * (push.along - along_);
  const double against = -beside_ * work_on(turned, way);
  const double left =
      (kCapAcross - 1.0) * (way.shift.squaredNorm() / per_cap_t_ +
                            (per_cap_r_ > 0.0 ? way.turn.squaredNorm() / per_cap_r_ : 0.0));
  if (against > left)
    turned *= left / against;
  along_ = push.direction(along_ + turned);
}

/// By how much g grows where w has grown by `more`.
double StiffnessCap::growth(const Push& push, const CouplingInput& input, const ToolStep& way,
                            double more) const noexcept {
  // On the way out what the cap allows counts, not what has risen to it so far, so that no more
  // comes back than went in.
  const double rate = more < 0.0 ? allowed_ : scale_, grown = rate * more;
  if (!way.known || !(input.contact_depth_m > 0.0))
    return grown;
  const double in = -rate * work_on(push.per_way, way);
  const double slide =
      rate * kSlope * push.per_way.head<3>().norm() * across(way.shift, push.normal);
  const double steep = std::copysign(std::max(0.0, std::abs(in) - slide), in);
  if (input.depth_goes_on) {
    if (steep * more < 0.0)
      return 0.0;  // the wrench changes against the way
    return std::clamp(steep, std::min(grown, more), std::max(grown, more));
  }
  const double deeper =
      rate * push.per_way.head<3>().dot(push.normal) * (input.contact_depth_m - depth_m_);
  return deeper > 0.0 ? std::max(grown, std::min(steep, deeper))
                      : std::min(grown, std::max(steep, deeper));
}

/// What of g is given with the wrench, from `least` to `most`; the rest goes beside it.
double StiffnessCap::split(const Push& push, double least, double most, const ToolStep& way,
                           double dt_s) noexcept {
  if (given_ > most && !(beside_ > 0.0))
    turning_ = 0.0, along_ = push.along;
  else
    turning_ = std::clamp(turning_ + (given_ > most ? -dt_s : dt_s) / kDefaultRampS, 0.0, 1.0);
  const double with_wrench = std::min(least + turning_ * (given_ - least), most);
  given_ = std::min(given_, std::max(with_wrench, std::sqrt(2.0 * std::max(stored_j_, 0.0)) +
                                                      std::abs(work_on(along_, way))));
  stored_j_ = std::min(stored_j_, 0.5 * given_ * given_);
  const double agree = push.n.cwiseProduct(along_).dot(push.n.cwiseProduct(push.along));
  beside_ = std::max(0.0, given_ - with_wrench) * std::max(0.0, agree);
  return with_wrench;
}

}  // namespace voxtouch::coupling

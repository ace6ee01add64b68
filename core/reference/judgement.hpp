#pragma once
/// Judges a reported contact by the reference's gap. Pure arithmetic: no FCL, no files, no clock.
///
/// Symbols: e voxel edge; s gap (gap.hpp), t = max(0, -s); c chord error; g shell gap; o shell
/// offset.
///
/// Two hard rules, each a proof. A sample that one of them applies to is decided.
///  - s > sqrt(3) e + c + o: a colliding shell point shares a closed voxel with a static triangle,
///  so it is at most the
///    voxel's diagonal away from it. None may collide and no force may act.
///  - buried > sqrt(3)/2 e + g + c + o: some shell point lies within g of the deepest point of the
///  dynamic surface, hence
///    inside the static mesh, hence in a surface or an interior voxel. Some must collide. (`buried`
///    and not -s: a sphere may have sunk 5 mm into a plate of 1 mm, and its lowest point is then in
///    the air again. sqrt(3)/2 e is a safety margin for the exact shell.)
///
/// Between them lies the band, where these are checked; each breach is a disagreement.
///  - An interior voxel is wholly inside the static mesh: interior hits need s <= c + o.
///  - A sphere's cap within sqrt(3) e of its deepest point holds a shell point (if g <= sqrt(3) e).
///  If all of that cap is more
///    than e/4 + c + o inside, some point must collide. e/4 is for the cap's rim between the six
///    places where it is seen: they span a hexagon, and what lies outside of it is at most (1 - cos
///    30 deg) sqrt(3) e = 0.23 e from it. On flat faces this finds a missing contact from about t =
///    e/2 on.
///  - Wherever there is no hit there is no force; and where a depth beyond e/4 is reported, a
///  force.
///  - Depth to e. A colliding point x measures d = m.(c_v - x) to the tangent plane through its
///  voxel's centre c_v, and not to
///    the surface. The surface passes through the same voxel, so both planes are at most h = e/2
///    (|m_x|+|m_y|+|m_z|) <= sqrt(3)/2 e apart, either way; and the lowest shell point may be
///    missing from the sphere's pole by at most g, which costs sag = g^2 / (2 R) of depth (g, where
///    no sphere is declared). So |d - t| <= h + sag, which is below e on all but coarse shells: the
///    tolerance is max(e, h + sag) + c + o. From above it always holds. From below it holds only
///    while no point has gone through: behind the layer (at 1 to 1.5 e) points give no depth, and d
///    stays behind t by as much as one likes. Interior hits tell when that is so. A grid that is
///    shifted away by 2 e is caught by this rule and the one on caps, one that is shifted closer by
///    the first hard rule. A shift of which less than 1.5 e is along the face's normal may stay
///    unseen on that face. Not compared: where the static object is too thin or too split for depth
///    and gap to mean the same (depth_exact), and while the rendering says that it holds an old
///    depth.
///  - Direction to 20 degrees, of the force and of the mean normal, where the nearest face is
///  unique, t >= e/4 + o, at least 4
///    points collide with a coherence of 1/2 or more, none has gone through and the model is not in
///    its fallback. Points that touch while s > 0 do so by the accident of one voxel's corner, and
///    a sphere of 10 e has normals 34 degrees off there; in these frames, in retained ones and in
///    those with interior hits only the sign counts: neither may point more than 90 degrees away (s
///    < e/2). The o: voxel centres collide deeper or sooner than the surface does, and a law with
///    own normals pushes askew with them. Force laws with a tangential part (friction) keep within
///    20 degrees up to a coefficient of 0.3.
///  - Torque to the sphere's size: every push acts at a shell point, at most R + o + c from the
///  sphere's centre. Where all
///    pushes share one direction, the line the force acts along passes the centre at no more than
///    that: |torque - r x force| <= (R + o + c) |force|, r from the tool's origin to the centre.
///    Asked where the mean normal is coherent, none has gone through, and the model is not in its
///    fallback; of a law with own normals the pushes are almost radial there, and keep to it with
///    room. A sphere about the tool's origin (r = 0) shows no sign of the torque: all of it is the
///    shell's noise. On a handle a wrong sign or a wrong point of reference shows.
///  - A frozen force: the wrench is not zero, not flagged as held, and bit for bit the same in 3 or
///  more checked samples
///    during which the gap has changed by more than e/4. Any real law answers a change of depth
///    with other bits; sliding along a face aligned with the grid may not, which is why the gap
///    counts and not the tool's path.
///
/// A breach is the rendering's fault where the reference's own cross-checks hold
/// (GapResult::self_check), else the reference's. Without a breach a failed cross-check leaves the
/// sample undecided, and the explanation says so.
#include <cstdint>
#include <limits>
#include <string>

#include "core/reference/gap.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Values of ValidationReport.verdict and .cause.
enum class Verdict : std::uint32_t { kAgree = 0, kInBand = 1, kDisagree = 2 };
enum class Cause : std::uint32_t { kNone = 0, kRendering = 1, kReference = 2 };

/// What the rules need to know of the scene. Lengths [m].
struct JudgeSettings {
  double edge_m = 0.0;         ///< voxel edge e, > 0
  double chord_error_m = 0.0;  ///< ReferenceScene::chord_error_m
  /// Every point of the dynamic surface has a shell point this near. The largest distance between
  /// shell points of neighbouring voxels is a good measure; sqrt(3) e always holds for an exact
  /// shell (surface and point share a voxel).
  double shell_gap_m = 0.0;
  double shell_offset_m =
      0.0;  ///< shell points off the surface: 0 for exact shells, sqrt(3)/2 e for voxel centres
  /// Throws std::invalid_argument naming field, value and rule.
  void validate() const;
};

/// The contact under judgement, as ContactState reports it. World frame.
struct ReportedContact {
  Pose pose_WT;
  Wrench wrench;
  Vec3 mean_normal = Vec3::Zero();
  double deepest_depth_m = 0.0;
  double coherence = 0.0;
  std::uint32_t surface_hits = 0, interior_hits = 0;
  double left_out_depth_m = 0.0;  ///< by a time budget; 0: every point was asked
  bool retained = false;          ///< FLAG_HELD
  bool fallback = false;          ///< FLAG_FALLBACK
};

struct Judgement {
  Verdict verdict = Verdict::kInBand;
  Cause cause = Cause::kNone;
  bool decided = false;  ///< one of the two hard rules applied
  double depth_error_m =
      std::numeric_limits<double>::quiet_NaN();  ///< reported - t; NaN: not compared
  double direction_error_rad =
      std::numeric_limits<double>::quiet_NaN();  ///< larger of force and normal; NaN: not compared
  std::string explanation;                       ///< empty unless something is wrong
};

struct JudgeCounts {
  std::uint64_t checked = 0, decided = 0, agree = 0, in_band = 0, disagree = 0;
  std::uint64_t rendering = 0, reference = 0;  ///< the disagreements by cause
};

/// Which samples are checked: every n-th by sequence number, so that the choice does not depend on
/// timing.
constexpr bool is_checked(std::uint64_t sequence_number, std::uint64_t every) noexcept {
  return every > 0 && sequence_number % every == 0;
}

struct ToolSettings;
struct ReportedTool;

/// Keeps the counts and the last wrench; samples must come in the order of their sequence numbers.
/// Not real-time (sentences).
class Judge {
 public:
  /// Throws what JudgeSettings::validate throws.
  explicit Judge(const JudgeSettings& settings);

  /// One sample of a contact by penalty: whether the report can be true where the gap is `gap`.
  /// Allocates.
  Judgement judge(const GapResult& gap, const ReportedContact& report);
  /// Of a virtual tool, by other rules: tool_judgement.hpp.
  Judgement judge(const GapResult& at_tool, const GapResult& at_hand, const ToolSettings& tool,
                  const ReportedTool& report);

  const JudgeCounts& counts() const noexcept { return counts_; }
  /// Another scene within the session: counts go on, memory begins anew. Throws as the constructor.
  void change(const JudgeSettings& settings);

  double free_limit_m() const noexcept;  ///< a gap above it is free
  double buried_limit_m()
      const noexcept;  ///< a depth above it must collide, if no point is left out

 private:
  /// Checked samples in a row with the same bits in the wrench.
  struct Run {
    Wrench wrench;
    int samples = 0;
    double least_gap_m = 0.0, largest_gap_m = 0.0;
  };
  void follow(const GapResult& gap, const ReportedContact& report);
  std::string not_usable(const ReportedContact& report) const;
  std::string breach(const GapResult& gap, const ReportedContact& report, Judgement& out) const;
  std::string hits_breach(const GapResult& gap, const ReportedContact& report,
                          Judgement& out) const;
  std::string force_breach(const ReportedContact& report) const;
  std::string depth_breach(const GapResult& gap, const ReportedContact& report,
                           Judgement& out) const;
  std::string direction_breach(const GapResult& gap, const ReportedContact& report,
                               Judgement& out) const;
  std::string torque_breach(const GapResult& gap, const ReportedContact& report) const;
  /// Verdict and cause from the explanation found; `checked`: the reference's own cross-checks
  /// hold.
  static void conclude(bool checked, Judgement& out);
  void count(const Judgement& judgement) noexcept;

  JudgeSettings settings_;
  JudgeCounts counts_;
  Run run_;
};

}  // namespace voxtouch::reference

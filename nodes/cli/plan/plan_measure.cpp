#include "nodes/cli/plan/plan_measure.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/accuracy/tool_row.hpp"
#include "core/coupling/running_coupling.hpp"
#include "core/device_fit/coupling_input.hpp"
#include "core/effects/body.hpp"

namespace voxtouch::cli {
namespace {

/// Calls in one reading of the clock: enough that its own steps do not show, few enough that a
/// frame stays short.
constexpr int kBatch = 16;
/// Duration of a circle or of a reciprocating motion, which have no end.
constexpr double kAfterApproachS = 4.0;
constexpr std::uint32_t kSeed = 1;

/// Without a motion to a place, the hand moves straight in from outside: so many frames, from this
/// distance before the touch to this distance behind it.
constexpr int kLeadFrames = 33;
constexpr double kLeadEdges = 2.0;

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0
                        : std::accumulate(values.begin(), values.end(), 0.0) /
                              static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  if (values.empty())
    return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Position of the tool in frame `n` of `frames`: equally spaced over the first motion by name, or
/// about the tool's size from a surface voxel, chosen with a fixed seed.
class ToolPath {
 public:
  ToolPath(const scene::Scene& scene, const voxmap::Voxmap& voxmap, double reach_m, int frames)
      : frames_(frames),
        random_(kSeed),
        edge_m_(voxmap.grid().edge) {
    if (!scene.motions.empty()) {
      name_ = scene.motions.begin()->first, motion_ = scene.motions.begin()->second;
      duration_s_ = approach_duration(*motion_) +
                    (motion_->circle_centre || motion_->repeat_from ? kAfterApproachS : 0.0);
      return;
    }
    reach_m_ = reach_m;
    voxmap.for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) {
      if (kind == voxmap::VoxelKind::kSurface)
        surface_.push_back(voxmap.grid().centre(v));
    });
  }
  const std::string& name() const { return name_; }
  double step_s() const { return motion_ ? duration_s_ / frames_ : 1e-3; }
  rendering::ToolState at(int n) {
    if (motion_)
      return along(step_s() * n);
    rendering::ToolState tool;
    if (surface_.empty())
      return tool;
    const auto draw = [this] {
      return 2.0 * static_cast<double>(random_()) / static_cast<double>(std::mt19937::max()) - 1.0;
    };
    const double x = draw(), y = draw(), z = draw();
    from_surface_ = Vec3(x, y, z).normalized();
    tool.pose.position = surface_[random_() % surface_.size()] + reach_m_ * from_surface_;
    return tool;
  }
  bool leads() const { return motion_.has_value(); }
  /// Path of the hand to the place of frame `n`, at most 1 ms per step: along the motion, or
  /// straight in.
  std::vector<rendering::ToolState> lead(int n) {
    std::vector<rendering::ToolState> out;
    if (motion_) {
      const double from_s = step_s() * std::max(n - 1, 0), path_s = step_s() * n - from_s;
      const int steps = std::max(1, static_cast<int>(std::ceil(path_s / 1e-3)));
      for (int k = 1; k <= steps; ++k)
        out.push_back(along(from_s + path_s * k / steps));
      return out;
    }
    out.assign(kLeadFrames, at(n));
    for (int k = 0; k < kLeadFrames; ++k)
      out[static_cast<std::size_t>(k)].pose.position +=
          kLeadEdges * edge_m_ * (1.0 - 2.0 * k / (kLeadFrames - 1)) * from_surface_;
    return out;
  }

 private:
  rendering::ToolState along(double t_s) const {
    const MotionPoint point = motion_at(*motion_, t_s);
    const MotionOrientation angular = orientation_at(*motion_, t_s);
    rendering::ToolState tool;
    tool.pose = {point.position, angular.orientation};
    tool.twist = {point.velocity, angular.rate};
    return tool;
  }

  int frames_;
  std::mt19937 random_;
  std::string name_;
  std::optional<Motion> motion_;
  double duration_s_ = 0.0;
  double reach_m_ = 0.0, edge_m_;
  Vec3 from_surface_ = Vec3::Zero();  ///< unit, of the last place without a motion
  std::vector<Vec3> surface_;         ///< centres of voxels; empty with a motion
};

class Stopwatch {
 public:
  explicit Stopwatch(const std::function<double()>& clock) : clock_(clock) {
    for (int n = 0; n < 100; ++n) {
      const double begin = clock_();
      overhead_s_ = std::min(overhead_s_, clock_() - begin);
    }
  }
  /// Nanoseconds of one call, the best of three batches, which excludes interruptions.
  template <class Call>
  double ns(Call&& call) const {
    double best = 1e9;
    for (int round = 0; round < 3; ++round) {
      const double begin = clock_();
      for (int n = 0; n < kBatch; ++n)
        call();
      best = std::min(best, clock_() - begin - overhead_s_);
    }
    return std::max(0.0, best) * 1e9 / kBatch;
  }
  /// Nanoseconds of this one call.
  template <class Call>
  double once_ns(Call&& call) const {
    const double begin = clock_();
    call();
    return std::max(0.0, clock_() - begin - overhead_s_) * 1e9;
  }

 private:
  const std::function<double()>& clock_;
  double overhead_s_ = 1.0;
};

struct Samples {
  std::vector<double> find, rest, frame, tested, hits, coupling;
  std::vector<double> queries, work;  ///< of a virtual tool
  std::vector<std::vector<double>> effects;
};

class Measurement {
 public:
  Measurement(const scene::Scene& scene, rendering::BuiltScene& built,
              const MeasureOptions& options)
      : scene_(scene),
        built_(built),
        path_(scene, built.voxmap(), built.renderer().query().reach_m(), options.frames),
        watch_(options.cpu_time_s) {
    samples_.effects.resize(scene.effects.size());
    for (const effects::EffectSpec& effect : scene.effects)
      alone_.emplace_back(std::vector<effects::EffectSpec>{effect});
    if (options.coupling)
      coupling_.emplace(*options.coupling, coupling::CouplingLimits{}, kDefaultS);
    hits_.reserve(built.renderer().query().shell().size());
    built.scene_renderer().reset();
    built.scene_renderer().set_spring_target(kSpringNPerM);
  }

  /// Frames in contact count, if there are any; the others are kept separately.
  void frame(int n, PlanTimes& out) {
    if (scene_.virtual_tool())
      return slide(n, out);
    const rendering::ToolState tool = path_.at(n);
    rendering::ObjectContacts& contacts = built_.contacts();
    double time_s = static_cast<double>(n), hits = 0.0, tested = 0.0;
    for (std::size_t o = 0; o < contacts.size(); ++o) {
      contacts.object(o).renderer->query().find(tool.pose, hits_);
      hits += static_cast<double>(hits_.surface.size() + hits_.interior.size()),
          tested += hits_.tested;
    }
    const bool touches = hits > 0.0;
    if (!touches && out.touching > 0)
      return free_frame(tool, time_s);
    if (touches && out.touching++ == 0)
      begin_contact();
    double find = 0.0;
    for (std::size_t o = 0; o < contacts.size(); ++o)
      find += watch_.ns([&] { contacts.object(o).renderer->query().find(tool.pose, hits_); });
    contact::StageResult touch;
    const double whole = watch_.ns([&] { touch = contacts.render(tool.pose, 0.0); });
    samples_.find.push_back(find);
    samples_.rest.push_back(std::max(0.0, whole - find));
    samples_.tested.push_back(tested);
    samples_.hits.push_back(hits);
    const effects::EffectFrame in =
        built_.scene_renderer().effect_frame(tool, kDefaultS, time_s, contacts.parts(touch));
    for (std::size_t e = 0; e < alone_.size(); ++e)
      samples_.effects[e].push_back(watch_.ns([&] { effect_force_ = alone_[e].apply(in); }));
    rendering::SceneFrame all;
    samples_.frame.push_back(
        watch_.ns([&] { all = built_.scene_renderer().render(tool, time_s += kDefaultS); }));
    if (coupling_) {
      const coupling::CouplingInput input = device_fit::coupling_input(all, tool.pose);
      samples_.coupling.push_back(watch_.ns([&] { coupling_->step(input, kDefaultS); }));
    }
  }

  /// The same for a virtual tool, from the place that the hand is led to.
  void slide(int n, PlanTimes& out) {
    rendering::SceneRenderer& renderer = built_.scene_renderer();
    if (!path_.leads())
      renderer.reset_virtual_tool();
    rendering::SceneFrame frame;
    rendering::ToolState hand;
    for (const rendering::ToolState& next : path_.lead(n))
      frame = renderer.render(hand = next, time_s_ += kDefaultS);
    const Vec3 normal = frame.touch.contact.mean_normal;
    if (frame.tool.constrained && out.touching++ == 0)
      begin_contact();
    const bool counts = frame.tool.constrained || out.touching == 0;
    double effects = 0.0;
    if (counts) {
      rendering::ObjectContacts& contacts = built_.contacts();
      const effects::EffectFrame in = renderer.effect_frame(
          hand, kDefaultS, time_s_, contacts.parts(contacts.render(hand.pose, 0.0)));
      for (std::size_t e = 0; e < alone_.size(); ++e) {
        samples_.effects[e].push_back(watch_.ns([&] { effect_force_ = alone_[e].apply(in); }));
        effects += samples_.effects[e].back();
      }
      if (coupling_) {
        const coupling::CouplingInput input = device_fit::coupling_input(frame, hand.pose);
        samples_.coupling.push_back(watch_.ns([&] { coupling_->step(input, kDefaultS); }));
      }
    }
    const Vec3 aside = normal.isZero(0.0) ? Vec3(Vec3::UnitX()) : normal.unitOrthogonal();
    for (int k = 0; k < kBatch; ++k) {
      hand.pose.position += accuracy::kSlideEdges * scene_.voxel_size_m * aside;
      const double ns =
          watch_.once_ns([&] { frame = renderer.render(hand, time_s_ += kDefaultS); });
      if (!frame.tool.constrained || !counts) {
        free_.push_back(ns);
        continue;
      }
      samples_.frame.push_back(ns);
      samples_.queries.push_back(frame.tool.queries),
          samples_.work.push_back(static_cast<double>(frame.tool.work));
      samples_.tested.push_back(frame.touch.contact.points_tested),
          samples_.hits.push_back(frame.touch.contact.surface_hits);
      samples_.rest.push_back(std::max(0.0, ns - effects));
    }
  }

  /// A body's motion is in the frame, not in its effect: it is timed by itself.
  double measured(std::size_t effect) {
    const effects::EffectSpec& spec = scene_.effects[effect];
    const std::optional<effects::BodyShape>& shape = built_.effect_ground().body;
    if (!spec.kind->needs(spec.values).body || !shape)
      return median(samples_.effects[effect]);
    effects::RigidBody body(*shape);
    body.place({}, true);
    const effects::BodyParameters parameters = effects::body_parameters(spec.values);
    return watch_.ns([&] { grip_ = body.step({}, {}, {}, true, 0.0, parameters, kDefaultS); });
  }

  /// Frames up to here were out of contact.
  void begin_contact() {
    free_.insert(free_.end(), samples_.frame.begin(), samples_.frame.end());
    samples_ = {};
    samples_.effects.resize(scene_.effects.size());
  }

  void free_frame(const rendering::ToolState& tool, double time_s) {
    free_.push_back(watch_.ns([&] { built_.scene_renderer().render(tool, time_s += kDefaultS); }));
  }

  void add_model(PlanTimes& out) {
    out.parts.push_back(
        {"pointshell", rendering::kNsPerPoint * out.points_tested, median(samples_.find)});
    const std::string& model = built_.plan().contact_model;
    out.parts.push_back({"contact model " + model,
                         rendering::kNsPerFrame + rendering::ns_per_contact_point(model) * out.hits,
                         median(samples_.rest)});
  }

  void sum_up(PlanTimes& out) {
    out.along = path_.name();
    out.points_tested = median(samples_.tested), out.hits = median(samples_.hits);
    out.slides = scene_.virtual_tool();
    if (out.slides)
      out.queries_per_frame = mean(samples_.queries);
    if (out.slides)
      out.parts.push_back(
          {"virtual tool", rendering::kNsPerWork * median(samples_.work), median(samples_.rest)});
    else
      add_model(out);
    for (std::size_t e = 0; e < alone_.size(); ++e) {
      const effects::EffectSpec& effect = scene_.effects[e];
      out.parts.push_back(
          {"effect " + effect.name,
           rendering::expected_ns(effect, built_.effect_ground().tool.points.size()), measured(e)});
    }
    if (coupling_)
      out.parts.push_back({"coupling", rendering::kNsPerCoupling, median(samples_.coupling)});
    std::vector<double> frames = samples_.frame.empty() ? free_ : samples_.frame;
    std::sort(frames.begin(), frames.end());
    if (frames.empty())
      return;
    out.frame_free_ns = out.touching > 0 ? median(free_) : median(frames);
    out.frame_median_ns = median(frames), out.frame_worst_ns = frames.back();
    out.frame_p95_ns = frames[std::min(frames.size() - 1, frames.size() * 95 / 100)];
  }

 private:
  static constexpr double kSpringNPerM =
      300.0;  ///< of a virtual tool: displayed by a typical device
  static constexpr double kDefaultS = rendering::SceneRenderer::kDefaultStepS;
  const scene::Scene& scene_;
  rendering::BuiltScene& built_;
  ToolPath path_;
  Stopwatch watch_;
  std::vector<effects::EffectChain> alone_;
  std::optional<coupling::RunningCoupling> coupling_;
  contact::HitList hits_;
  effects::EffectForce effect_force_;
  effects::BodyGrip grip_;
  Samples samples_;
  double time_s_ = 0.0;       ///< of a virtual tool's frames
  std::vector<double> free_;  ///< whole frames out of contact
};

}  // namespace

PlanTimes measure_plan(const scene::Scene& scene, rendering::BuiltScene& built,
                       const MeasureOptions& options) {
  PlanTimes out;
  out.frames = options.frames;
  Measurement measurement(scene, built, options);
  for (int n = 0; n < options.frames; ++n)
    measurement.frame(n, out);
  measurement.sum_up(out);
  built.scene_renderer().reset();
  return out;
}

}  // namespace voxtouch::cli

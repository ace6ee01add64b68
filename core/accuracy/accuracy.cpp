#include "core/accuracy/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>

#include "core/accuracy/contact_errors.hpp"
#include "core/accuracy/contact_places.hpp"
#include "core/accuracy/estimated_costs.hpp"
#include "core/accuracy/measured_progress.hpp"
#include "core/accuracy/tool_row.hpp"
#include "core/accuracy/true_forces.hpp"
#include "core/accuracy/true_tools.hpp"
#include "core/reference/reference_mesh.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/contact_parameters.hpp"

namespace voxtouch::accuracy {
namespace {

constexpr int kRounds = 5;  ///< that times are taken in
constexpr double kLookAheadEdges = 2.0, kLookInEdges = 1.5,
                 kStepEdges = 1.0 / 32.0;  ///< step of the search for the onset
constexpr int kHalvings = 12;
constexpr double kPressEdges =
    0.25;  ///< a frame, for the spread over depth: below half a voxel nothing counts as fast

/// Below the requested depth, interpolated distances read nodes within a voxel's diagonal.
constexpr double kNodesBelowVoxels = 2.0;

/// The gap at which the force begins on the path in; minus the last tested depth if there is none.
double onset_gap(contact::ContactRenderer& renderer, const ContactPlace& place, double edge) {
  const auto has_force = [&](double depth) {
    return !renderer.probe(place.at(depth)).wrench.force.isZero(0.0);
  };
  double before = -kLookAheadEdges * edge, step = kStepEdges * edge;
  while (before < kLookInEdges * edge && !has_force(before + step))
    before += step;
  for (int n = 0; n < kHalvings; ++n) {
    step *= 0.5;
    if (!has_force(before + step))
      before += step;
  }
  return -(before + step);
}

/// Stiffness of the law that a shell's points make up together [N/m^3], whatever each of them
/// weighs.
double law_stiffness(const contact::ContactParameters& parameters,
                     const pointshell::Pointshell& shell) {
  if (parameters.weights == contact::PointWeights::kArea)
    return parameters.stiffness;
  double area = 0.0;
  for (const double a : shell.area_m2)
    area += a;
  return parameters.stiffness * static_cast<double>(shell.size()) / area;
}

EstimatedCosts estimated_costs(const scene::Scene& scene) {
  EstimatedCosts costs;
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    const reference::ReferenceMesh mesh = reference::read_reference_mesh(spec);
    costs.triangles += static_cast<double>(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      costs.area_m2 += 0.5 * (mesh.corner(t, 1) - mesh.corner(t, 0))
                                 .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                                 .norm();
  }
  return costs;
}

void widen(Interval& all, double value) {
  all.low = std::isnan(all.low) ? value : std::min(all.low, value);
  all.high = std::isnan(all.high) ? value : std::max(all.high, value);
}

class Measurement {
 public:
  Measurement(const scene::Scene& scene, const AccuracyOptions& options,
              const ParallelFor& parallel_for, const std::vector<AccuracySetting>& settings)
      : scene_(scene),
        options_(options),
        parallel_for_(parallel_for),
        settings_(settings),
        costs_(estimated_costs(scene)),
        progress_(options.cpu_time_s, options.progress) {
    if (!scene.objects.empty())
      throw std::runtime_error(
          scene.file.string() +
          ": the reference force needs one material at rest; this scene has objects");
    plan_steps();
    progress_.begin(Step::kPlaces, "contact places", costs_.places_s(options.contacts));
    reference_ = std::make_unique<reference::ReferenceScene>(scene);
    places_ = contact_places(scene, options.contacts, options.seed,
                             [this](double fraction) { progress_.at(fraction); });
    if (places_.empty())
      throw std::runtime_error(
          scene.file.string() +
          ": no contact place found outside; the tool may be larger than the static meshes");
  }

  std::vector<AccuracyRow> rows() {
    std::vector<AccuracyRow> rows;
    for (const AccuracySetting& setting : settings_)
      rows.push_back(row(setting));
    for (const double voxel_m : voxel_sizes())
      add_phases(voxel_m, rows);
    return rows;
  }

 private:
  /// Created on demand: for a scene without an inside the row then reports the reason.
  TrueForces& truth() {
    if (!truth_)
      truth_ = std::make_unique<TrueForces>(scene_);
    return *truth_;
  }
  TrueTools& true_tools() {
    if (!true_tools_)
      true_tools_ = std::make_unique<TrueTools>(scene_, *reference_);
    return *true_tools_;
  }
  double now() const { return options_.cpu_time_s ? options_.cpu_time_s() : 0.0; }
  std::size_t spread_count() const {
    return std::min<std::size_t>(options_.spread_contacts, places_.size());
  }

  /// In the order of their first occurrence.
  std::vector<double> voxel_sizes() const {
    std::vector<double> out;
    for (const AccuracySetting& s : settings_)
      if (std::find(out.begin(), out.end(), s.voxel_m) == out.end())
        out.push_back(s.voxel_m);
    return out;
  }

  /// Depths at which the rows of a voxel size are evaluated, with the number of places. The first
  /// is `first_edges` voxels.
  std::vector<std::pair<double, std::size_t>> truths_of(double voxel_m, double first_edges) const {
    std::vector<std::pair<double, std::size_t>> out = {{first_edges * voxel_m, options_.contacts}};
    if (options_.spread_contacts > 0)
      for (const double edges : options_.spread_depth_edges)
        out.emplace_back(edges * voxel_m, std::min(options_.spread_contacts, options_.contacts));
    return out;
  }

  void plan_steps() {
    progress_.plan(Step::kPlaces, costs_.places_s(options_.contacts));
    std::map<double, std::size_t> truths, tool_truths;
    for (const AccuracySetting& s : settings_) {
      progress_.plan(Step::kBuild, costs_.build_s(s)),
          progress_.plan(Step::kJudge, costs_.judge_s(s, options_.contacts));
      std::map<double, std::size_t>& all = s.virtual_tool ? tool_truths : truths;
      for (const auto& [depth_m, count] : truths_of(s.voxel_m, judged_edges(s)))
        all[depth_m] = std::max(all[depth_m], count);
    }
    for (const auto& [depth_m, count] : truths)
      progress_.plan(Step::kTruth, costs_.truth_s(count));
    for (const auto& [depth_m, count] : tool_truths)
      progress_.plan(Step::kToolTruth, tool_truth_estimate_s(count));
    if (options_.spread_contacts > 0)
      for (const double voxel_m : voxel_sizes())
        progress_.plan(Step::kPhase, options_.phases * costs_.phase_s(voxel_m));
  }

  double judged_edges(const AccuracySetting& setting) const {
    return setting.virtual_tool ? kHandDepthEdges : options_.depth_edges;
  }
  double tool_truth_estimate_s(std::size_t count) const {
    return costs_.tool_truth_s(count, tool_truth(scene_) == ToolTruth::kGodObject);
  }

  AccuracyRow row(const AccuracySetting& setting) {
    AccuracyRow row;
    row.setting = setting;
    try {
      const std::string name(setting.virtual_tool ? "virtual tool"
                                                  : contact::name_of(setting.model));
      progress_.begin(Step::kBuild, "building " + name, costs_.build_s(setting));
      const double begin = now();
      const std::unique_ptr<rendering::BuiltScene> built = build(setting, scene_.grid_origin);
      row.build_s = now() - begin;
      row.shell_points = built->plan().shell_points, row.bytes = built->plan().bytes;
      origins_.emplace(setting.voxel_m, built->voxmap().grid().origin);
      // After the build: a voxel size that is too fine to build is also too fine to integrate.
      if (setting.virtual_tool)
        compute_tool_truth(setting.voxel_m);
      else
        compute_truth(setting.voxel_m);
      progress_.begin(Step::kJudge, name, costs_.judge_s(setting, options_.contacts));
      if (setting.virtual_tool) {
        judge_tool(*built, row);
        return row;
      }
      const pointshell::Pointshell& shell = built->renderer().query().shell();
      shells_.emplace(setting.shell_voxel_m, shell);
      judge(built->renderer(), law_stiffness(parameters(setting, shell), shell), row);
    } catch (const std::exception& error) {
      row = {};
      row.setting = setting;
      row.refused = error.what();
    }
    return row;
  }

  /// `depth_m`: largest depth of the tool's points, which limits the distances to build; none: all
  /// are built.
  std::unique_ptr<rendering::BuiltScene> build(const AccuracySetting& setting,
                                               const std::optional<Vec3>& origin,
                                               std::optional<double> depth_m = std::nullopt) {
    scene::Scene scene = scene_;
    scene.voxel_size_m = setting.voxel_m;
    scene.grid_origin = origin;
    scene.contact.model = contact::name_of(setting.model);
    if (setting.virtual_tool)
      scene.contact.rendering = scene::RenderingKind::kVirtualTool;
    scene.effects.clear();
    return rendering::build_scene(
        scene, parallel_for_,
        {.model = setting.model,
         .weights = setting.weights,
         .shell_voxel_m = setting.shell_voxel_m,
         .field_depth_voxels =
             depth_m ? std::optional(std::max(0.0, *depth_m / setting.voxel_m) + kNodesBelowVoxels)
                     : std::nullopt,
         .read = options_.read});
  }
  contact::ContactParameters parameters(const AccuracySetting& setting,
                                        const pointshell::Pointshell& shell) const {
    return rendering::contact_parameters(scene_.contact, setting.model, shell, setting.weights);
  }

  /// The reference that the rows of this voxel size are compared with.
  void compute_truth(double voxel_m) {
    if (!known_.insert({voxel_m, true}).second)
      return;
    for (const auto& [depth_m, count] : truths_of(voxel_m, options_.depth_edges)) {
      progress_.begin(Step::kTruth, "true forces",
                      costs_.truth_s(truth().unknown(places_, count, depth_m)));
      truth().at(places_, count, depth_m, [this](double fraction) { progress_.at(fraction); });
    }
  }

  void compute_tool_truth(double voxel_m) {
    for (const auto& [depth_m, count] : truths_of(voxel_m, kHandDepthEdges)) {
      progress_.begin(Step::kToolTruth, "true virtual tool",
                      tool_truth_estimate_s(true_tools().unknown(places_, count, depth_m)));
      true_tools().at(places_, count, depth_m, [this](double fraction) { progress_.at(fraction); });
    }
  }

  /// Whether the path in is free from the start of the onset search: in a narrow place another wall
  /// may be behind the tool.
  const std::vector<bool>& clear_before(double edge) {
    std::vector<bool>& clear = clear_[edge];
    const double ahead = kLookAheadEdges * edge;
    while (clear.size() < places_.size()) {
      const ContactPlace& place = places_[clear.size()];
      clear.push_back(reference_->apart_m(place.at(-ahead)) > 0.5 * ahead &&
                      reference_->apart_m(place.at(-0.5 * ahead)) > 0.25 * ahead);
    }
    return clear;
  }

  static std::vector<WrenchPair> scaled(const std::vector<Wrench>& requested, double stiffness) {
    std::vector<WrenchPair> pairs;
    for (const Wrench& w : requested)
      pairs.push_back({{}, {stiffness * w.force, stiffness * w.torque}});
    return pairs;
  }

  void judge(contact::ContactRenderer& renderer, double stiffness, AccuracyRow& row) {
    const double edge = row.setting.voxel_m, depth = options_.depth_edges * edge;
    const std::vector<Wrench> requested = truth().at(places_, places_.size(), depth);
    const std::vector<bool>& clear = clear_before(edge);
    std::vector<WrenchPair> pairs = scaled(requested, stiffness);
    std::vector<double> onsets;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      progress_.at(static_cast<double>(n) / static_cast<double>(places_.size()));
      if (requested[n].force.isZero(0.0))
        continue;
      pairs[n].given = renderer.probe(places_[n].at(depth)).wrench;
      if (clear[n])
        onsets.push_back(onset_gap(renderer, places_[n], edge));
    }
    judge_wrenches(pairs, row);
    judge_onsets(onsets, row);
    measure_times(renderer, requested, depth, row);
    judge_depths(renderer, stiffness, row);
  }

  void judge_depths(contact::ContactRenderer& renderer, double stiffness, AccuracyRow& row) {
    if (spread_count() == 0 || options_.spread_depth_edges.empty())
      return;
    const double edge = row.setting.voxel_m;
    std::vector<std::vector<WrenchPair>> pairs;
    for (const double edges : options_.spread_depth_edges)
      pairs.push_back(scaled(truth().at(places_, spread_count(), edges * edge), stiffness));
    for (std::size_t n = 0; n < spread_count(); ++n) {
      renderer.reset();
      double at = -1.0;
      for (std::size_t d = 0; d < pairs.size(); ++d) {  // rising, as options are read
        for (; at < options_.spread_depth_edges[d]; at += kPressEdges)
          renderer.render(places_[n].at(at * edge));
        pairs[d][n].given =
            renderer.render(places_[n].at(options_.spread_depth_edges[d] * edge)).contact.wrench;
      }
    }
    renderer.reset();
    for (std::size_t d = 0; d < pairs.size(); ++d) {
      DepthFigures& figures = row.depths.emplace_back();
      figures.edges = options_.spread_depth_edges[d];
      judge_forces(pairs[d], figures);
    }
  }

  void judge_tool(rendering::BuiltScene& built, AccuracyRow& row) {
    const double edge = row.setting.voxel_m, depth = kHandDepthEdges * edge;
    ToolPress press(built, edge);
    std::vector<WrenchPair> pairs = scaled(true_tools().at(places_, places_.size(), depth), 1.0);
    row.tool_truth = true_tools().kind();
    row.without_truth = true_tools().unsettled(depth);
    std::vector<std::vector<SlideFrame>> slides;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      progress_.at(static_cast<double>(n) / static_cast<double>(places_.size()));
      pairs[n].given = press.into(places_[n], depth);
      slides.push_back(press.slide(places_[n], depth, options_.cpu_time_s));
    }
    judge_wrenches(pairs, row);
    store_slides(slides, row);
    row.onset_error_m = row.onset_worst_m =
        std::numeric_limits<double>::quiet_NaN();  // it has none
    if (spread_count() == 0)
      return;
    for (const double edges : options_.spread_depth_edges) {
      pairs = scaled(true_tools().at(places_, spread_count(), edges * edge), 1.0);
      for (std::size_t n = 0; n < pairs.size(); ++n)
        pairs[n].given = press.into(places_[n], edges * edge);
      DepthFigures& figures = row.depths.emplace_back();
      figures.edges = edges;
      judge_forces(pairs, figures);
    }
  }

  static void keep_times(std::vector<double> times_us, AccuracyRow& row) {
    if (times_us.empty())
      return;
    row.worst_us = *std::max_element(times_us.begin(), times_us.end());
    row.median_us = median_of(times_us), row.p95_us = p95_of(times_us);
    row.median_us_95 = median_interval(std::move(times_us));
  }

  /// Frames of one place are correlated, so the interval of the median is that of the places'
  /// medians.
  void store_slides(const std::vector<std::vector<SlideFrame>>& slides, AccuracyRow& row) const {
    const double clock_s = options_.cpu_time_s ? clock_cost_s() : 0.0;
    double queries = 0.0;
    std::vector<double> all, of_places;
    for (const std::vector<SlideFrame>& slide : slides) {
      std::vector<double> times;
      for (const SlideFrame& frame : slide)
        queries += frame.queries, times.push_back(1e6 * std::max(frame.time_s - clock_s, 0.0));
      all.insert(all.end(), times.begin(), times.end());
      of_places.push_back(median_of(std::move(times)));
    }
    row.queries_per_frame = queries / static_cast<double>(all.size());
    if (!options_.cpu_time_s)
      return;
    keep_times(std::move(all), row);
    row.median_us_95 = median_interval(std::move(of_places));
  }

  /// Cost of a clock call [s].
  double clock_cost_s() const {
    double clock_s = 1.0;
    for (int n = 0; n < 100; ++n) {
      const double begin = now();
      clock_s = std::min(clock_s, now() - begin);
    }
    return clock_s;
  }

  void measure_times(contact::ContactRenderer& renderer, const std::vector<Wrench>& requested,
                     double depth, AccuracyRow& row) const {
    if (!options_.cpu_time_s)
      return;
    const double clock_s = clock_cost_s();
    std::vector<double> all;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      if (requested[n].force.isZero(0.0))
        continue;
      double best = 1.0;
      for (int round = 0; round < kRounds; ++round) {
        renderer.reset();
        const double begin = now();
        renderer.render(places_[n].at(depth));
        best = std::min(best, std::max(now() - begin - clock_s, 0.0));
      }
      all.push_back(1e6 * best);
    }
    keep_times(std::move(all), row);
  }

  /// One distance field serves all models: the grid is built once for each of its places.
  void add_phases(double voxel_m, std::vector<AccuracyRow>& rows) {
    const auto origin = origins_.find(voxel_m);
    if (options_.phases == 0 || spread_count() == 0 || origin == origins_.end())
      return;
    std::mt19937_64 random(options_.seed);
    const auto fraction = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (std::uint32_t n = 0; n < options_.phases; ++n) {
      progress_.begin(Step::kPhase, "grid offsets", costs_.phase_s(voxel_m));
      const Vec3 moved(fraction(), fraction(), fraction());
      add_phase(voxel_m, origin->second - voxel_m * moved, rows);
    }
  }

  void add_phase(double voxel_m, const Vec3& origin, std::vector<AccuracyRow>& rows) {
    std::unique_ptr<rendering::BuiltScene> ground;
    for (AccuracyRow& row : rows) {
      const AccuracySetting& setting = row.setting;
      if (setting.voxel_m != voxel_m || !row.refused.empty())
        continue;
      try {
        ErrorFigures figures;
        if (setting.virtual_tool) {
          judge_forces(tool_at(origin, setting), figures);
        } else {
          if (!ground)
            ground = build(
                {contact::ContactModelKind::kField, contact::PointWeights::kArea, voxel_m, voxel_m},
                origin, options_.depth_edges * voxel_m);
          judge_forces(contacts_at(*ground, setting), figures);
        }
        ++row.phases.phases;
        row.phases.contacts = figures.contacts + figures.missed;
        widen(row.phases.direction_mean_deg, figures.direction_mean_deg);
        widen(row.phases.missed_ratio, figures.missed_ratio());
        widen(row.phases.force_ratio, figures.force_ratio);
      } catch (
          const std::exception&) {  // of this grid nothing is known: the row reports how many were
      }
    }
  }

  std::vector<WrenchPair> contacts_at(const rendering::BuiltScene& ground,
                                      const AccuracySetting& setting) {
    const pointshell::Pointshell& shell = shells_.at(setting.shell_voxel_m);
    const contact::ContactParameters law = parameters(setting, shell);
    contact::ContactRenderer renderer(ground.voxmap(), shell, setting.model, law, ground.field());
    const double depth = options_.depth_edges * setting.voxel_m;
    std::vector<WrenchPair> pairs =
        scaled(truth().at(places_, spread_count(), depth), law_stiffness(law, shell));
    for (std::size_t n = 0; n < pairs.size(); ++n)
      pairs[n].given = renderer.probe(places_[n].at(depth)).wrench;
    return pairs;
  }

  std::vector<WrenchPair> tool_at(const Vec3& origin, const AccuracySetting& setting) {
    const double depth = kHandDepthEdges * setting.voxel_m;
    const std::unique_ptr<rendering::BuiltScene> built = build(setting, origin, depth);
    ToolPress press(*built, setting.voxel_m);
    std::vector<WrenchPair> pairs = scaled(true_tools().at(places_, spread_count(), depth), 1.0);
    for (std::size_t n = 0; n < pairs.size(); ++n)
      pairs[n].given = press.into(places_[n], depth);
    return pairs;
  }

  const scene::Scene& scene_;
  const AccuracyOptions& options_;
  const ParallelFor& parallel_for_;
  const std::vector<AccuracySetting>& settings_;
  EstimatedCosts costs_;
  MeasuredProgress progress_;
  std::unique_ptr<TrueForces> truth_;
  std::unique_ptr<TrueTools> true_tools_;
  std::unique_ptr<reference::ReferenceScene> reference_;
  std::vector<ContactPlace> places_;
  std::map<double, bool> known_;                     ///< voxel sizes with a known reference
  std::map<double, std::vector<bool>> clear_;        ///< by voxel size, of each place
  std::map<double, Vec3> origins_;                   ///< of the grid, by voxel size
  std::map<double, pointshell::Pointshell> shells_;  ///< by the voxel size that they were made with
};

}  // namespace

std::vector<AccuracyRow> measure_accuracy(const scene::Scene& scene,
                                          const std::vector<AccuracySetting>& settings,
                                          const AccuracyOptions& options,
                                          const ParallelFor& parallel_for) {
  return Measurement(scene, options, parallel_for, settings).rows();
}

}  // namespace voxtouch::accuracy

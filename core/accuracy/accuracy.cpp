#include "core/accuracy/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include "core/accuracy/contact_errors.hpp"
#include "core/accuracy/contact_places.hpp"
#include "core/accuracy/tool_row.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/reference/reference_wrench.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::accuracy {
namespace {

constexpr double kFaintShare = 0.05;  ///< of the median true force: a contact below tells of rounding, not of a model
constexpr int kRounds = 5;            ///< that times are taken in
constexpr double kLookAheadEdges = 2.0, kLookInEdges = 1.5, kStepEdges = 1.0 / 32.0;  ///< where a force may begin
constexpr int kHalvings = 12;

/// True wrenches at every place, for one depth; zero where the contact is too faint to judge.
using Truth = std::vector<Wrench>;

Truth true_wrenches(const scene::Scene& scene, const std::vector<ContactPlace>& places, double depth_m) {
  const reference::ReferenceWrench reference(scene, depth_m);
  Truth truth;
  std::vector<double> sizes;
  for (const ContactPlace& place : places) {
    truth.push_back(reference.at(place.at(depth_m)).wrench);
    sizes.push_back(truth.back().force.norm());
  }
  const double faint = kFaintShare * median_of(sizes);
  for (Wrench& w : truth)
    if (!(w.force.norm() > faint)) w = {};
  return truth;
}

/// Whether the way in is free from where an onset is looked for: a narrow place may have another wall behind the tool.
bool clear_before(const reference::ReferenceScene& reference, const ContactPlace& place, double edge) {
  const double ahead = kLookAheadEdges * edge;
  return reference.gap(place.at(-ahead)).gap_m > 0.5 * ahead &&
         reference.gap(place.at(-0.5 * ahead)).gap_m > 0.25 * ahead;
}

/// The gap at which the force begins on the way in; minus the last depth looked at where it never does.
double onset_gap(contact::ContactRenderer& renderer, const ContactPlace& place, double edge) {
  const auto pushes = [&](double depth) { return !renderer.probe(place.at(depth)).wrench.force.isZero(0.0); };
  double before = -kLookAheadEdges * edge, step = kStepEdges * edge;
  while (before < kLookInEdges * edge && !pushes(before + step)) before += step;
  for (int n = 0; n < kHalvings; ++n) {
    step *= 0.5;
    if (!pushes(before + step)) before += step;
  }
  return -(before + step);
}

class Measurement {
 public:
  Measurement(const scene::Scene& scene, const AccuracyOptions& options, const ParallelFor& parallel_for, std::size_t settings)
      : scene_(scene), options_(options), parallel_for_(parallel_for), settings_(settings), reference_(scene) {
    if (!scene.objects.empty())
      throw std::runtime_error(scene.file.string() +
                               ": the true force is known for one material that rests; this scene has objects of their own");
    say("places where the tool touches", 0.0);
    places_ = contact_places(scene, options.contacts, options.seed);
    if (places_.empty())
      throw std::runtime_error(
          scene.file.string() +
          ": no place was found where the tool can touch from outside; is it larger than what it is to touch?");
  }

  AccuracyRow row(const AccuracySetting& setting) {
    AccuracyRow row;
    row.setting = setting;
    try {
      const double begin = now();
      const std::unique_ptr<rendering::BuiltScene> built = build(setting);
      row.build_s = now() - begin;
      row.shell_points = built->plan().shell_points, row.bytes = built->plan().bytes;
      if (setting.virtual_tool) {
        say("virtual tool", share());
        judge_tool(scene_, *built, reference_, places_, options_, row);
        ++done_;
        return row;
      }
      const Truth& truth = truth_at(options_.depth_edges * setting.voxel_m);
      say(std::string(contact::name_of(setting.model)), share());
      judge(built->contacts().object(0).renderer.value(), truth, row);
    } catch (const std::exception& error) {
      row = {};
      row.setting = setting;
      row.refused = error.what();
    }
    ++done_;
    return row;
  }

 private:
  double now() const { return options_.cpu_time_s ? options_.cpu_time_s() : 0.0; }
  double share() const { return (0.5 + static_cast<double>(done_)) / (1.0 + static_cast<double>(settings_)); }
  void say(const std::string& what, double share) const {
    if (options_.progress) options_.progress(what, share);
  }

  std::unique_ptr<rendering::BuiltScene> build(const AccuracySetting& setting) {
    say("building " + std::string(contact::name_of(setting.model)), share());
    scene::Scene scene = scene_;
    scene.voxel_size_m = setting.voxel_m;
    scene.contact.model = contact::name_of(setting.model);
    if (setting.virtual_tool) scene.contact.rendering = scene::RenderingKind::kVirtualTool;
    scene.effects.clear();
    return rendering::build_scene(scene, parallel_for_,
                       {.model = setting.model,
                        .weights = setting.weights,
                        .shell_voxel_m = setting.shell_voxel_m,
                        .read = options_.read});
  }

  const Truth& truth_at(double depth_m) {
    const auto found = truth_.find(depth_m);
    if (found != truth_.end()) return found->second;
    say("true forces", share());
    return truth_.emplace(depth_m, true_wrenches(scene_, places_, depth_m)).first->second;
  }

  void judge(contact::ContactRenderer& renderer, const Truth& truth, AccuracyRow& row) const {
    const double edge = row.setting.voxel_m, depth = options_.depth_edges * edge;
    std::vector<WrenchPair> pairs;
    std::vector<double> onsets;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      if (truth[n].force.isZero(0.0)) continue;
      pairs.push_back({renderer.probe(places_[n].at(depth)).wrench, truth[n]});
      if (clear_before(reference_, places_[n], edge)) onsets.push_back(onset_gap(renderer, places_[n], edge));
    }
    judge_wrenches(pairs, row);
    judge_onsets(onsets, row);
    measure_times(renderer, truth, depth, row);
  }

  void measure_times(contact::ContactRenderer& renderer, const Truth& truth, double depth, AccuracyRow& row) const {
    if (!options_.cpu_time_s) return;
    double clock_s = 1.0;  // what asking for the time costs
    for (int n = 0; n < 100; ++n) {
      const double begin = now();
      clock_s = std::min(clock_s, now() - begin);
    }
    std::vector<double> all;
    for (std::size_t n = 0; n < places_.size(); ++n) {
      if (truth[n].force.isZero(0.0)) continue;
      double best = 1.0;
      for (int round = 0; round < kRounds; ++round) {
        renderer.reset();
        const double begin = now();
        renderer.render(places_[n].at(depth));
        best = std::min(best, std::max(now() - begin - clock_s, 0.0));
      }
      all.push_back(1e6 * best);
      row.worst_us = std::max(row.worst_us, 1e6 * best);
    }
    row.median_us = median_of(std::move(all));
  }

  const scene::Scene& scene_;
  const AccuracyOptions& options_;
  const ParallelFor& parallel_for_;
  std::size_t settings_, done_ = 0;
  reference::ReferenceScene reference_;
  std::vector<ContactPlace> places_;
  std::map<double, Truth> truth_;
};

}  // namespace

std::vector<AccuracyRow> measure_accuracy(const scene::Scene& scene, const std::vector<AccuracySetting>& settings,
                                          const AccuracyOptions& options, const ParallelFor& parallel_for) {
  Measurement measurement(scene, options, parallel_for, settings.size());
  std::vector<AccuracyRow> rows;
  for (const AccuracySetting& setting : settings) rows.push_back(measurement.row(setting));
  return rows;
}

}  // namespace voxtouch::accuracy

// The paper's experiments as data: figures 2 and 3, 8, 9, 11, their figures of merit, and cases
// against its claims.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/experiments/paper/experiments.hpp"

namespace voxtouch::paper {
namespace {

using Json = nlohmann::json;

constexpr int kSteps = 720;

Quat about(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

Json of(const Merit& m) {
  return {{"what", m.what}, {"ours", m.ours},           {"least", m.least},
          {"most", m.most}, {"reference", m.reference}, {"conditions", m.conditions}};
}

/// Components of the force across the normal, over the mean force, along two axes that go with the
/// normal.
Json components(const Slide& slide, const Distraction& d) {
  Json first = Json::array(), second = Json::array(), normal = Json::array();
  for (int n = 0; n < kSteps; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double s = static_cast<double>(n) / kSteps;
    const Quat back = Quat::FromTwoVectors(slide.normal(s), Vec3::UnitZ());
    const Vec3 across = back * d.across[i] / d.mean;
    first.push_back(across.x()), second.push_back(across.y()),
        normal.push_back(d.along[i] / d.mean);
  }
  return {{"first", first},
          {"second", second},
          {"normal", normal},
          {"rms", d.rms},
          {"rms_about_mean", d.rms_about_mean},
          {"noise", d.noise}};
}

Json through_all_contact_cases(const Slide& slide, const Sphere& sphere) {
  const Ground ground(slide.mesh);
  Json out = Json::array();
  for (const ContactCase& contact_case : all_contact_cases()) {
    Json one =
        components(slide, distraction(renderer_of(contact_case, ground, sphere), slide, kSteps));
    one["contact_model"] = contact_case.name;
    out.push_back(one);
  }
  return out;
}

/// Points nearer to the plane z = 0 than half an edge, rotated with the sphere: x, y, and the
/// normal's.
Json slice(const pointshell::Pointshell& shell, const Quat& turn) {
  Json out = Json::array();
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 x = turn * shell.point(p), n = turn * shell.normal(p);
    if (std::abs(x.z()) < 0.5 * kEdge)
      out.push_back({x.x() / kEdge, x.y() / kEdge, n.x(), n.y()});
  }
  return out;
}

Json shells(const Sphere& sphere) {
  const Quat turn = about(25, Vec3(1, 2, 3));
  Json out{{"radius_edges", kRadius / kEdge}};
  for (const auto& [name, quat] : {std::pair{"still", Quat::Identity()}, std::pair{"turned", turn}})
    out[name] = {{"naive", slice(sphere.naive, quat)}, {"exact", slice(sphere.exact, quat)}};
  // The effect on the force: around a cylinder, in the frame that rotates with the normal.
  for (const auto& [name, quat] :
       {std::pair{"still", Quat::Identity()}, std::pair{"turned", turn}}) {
    const Slide slide = round_a_cylinder(20 * kEdge, 0.5, quat, 0.0007);
    const Ground ground(slide.mesh);
    ContactCase contact_case{"original", contact::ContactModelKind::kOriginal,
                             contact::PointWeights::kOne, true};
    out[name]["force_naive_original"] =
        components(slide, distraction(renderer_of(contact_case, ground, sphere), slide, kSteps));
    contact_case.naive = false;
    out[name]["force_exact_original"] =
        components(slide, distraction(renderer_of(contact_case, ground, sphere), slide, kSteps));
    contact_case.model = contact::ContactModelKind::kAdapted;
    out[name]["force_exact_adapted"] =
        components(slide, distraction(renderer_of(contact_case, ground, sphere), slide, kSteps));
  }
  return out;
}

Json filter() {
  const FilterExperiment e = filter_experiment();
  const auto smooth = [](const Smoothness& s) {
    return Json{{"noise", s.noise}, {"largest_step", s.largest_step}};
  };
  return {{"step_s", e.step_s},
          {"rise_time_s", e.rise_time_s},
          {"raw", e.raw},
          {"spring_damper", e.spring_damper},
          {"shaping_filter", e.shaping_filter},
          {"of_raw", smooth(e.of_raw)},
          {"of_spring_damper", smooth(e.of_spring_damper)},
          {"of_filter", smooth(e.of_filter)}};
}

void say(const char* what) { fmt::print(stderr, "{}\n", what); }

Json all(bool quick) {
  const Sphere sphere, symmetric(Vec3::Zero());
  Json out;
  say("experiment 1: a circle over a plane");
  out["plane_aligned"] = through_all_contact_cases(
      circle_on_plane("aligned", Quat::Identity(), 0.75, 0.5, Quat::Identity()), sphere);
  out["plane_tilted"] = through_all_contact_cases(
      circle_on_plane("tilted", about(26.6, Vec3(1, 0.3, 0)), 0.3, 0.5, Quat::Identity()), sphere);
  say("experiment 2: round a cylinder");
  out["cylinder"] = through_all_contact_cases(
      round_a_cylinder(20 * kEdge, 0.5, about(25, Vec3(1, 2, 3)), 0.0007), sphere);
  say("pointshells");
  out["shells"] = shells(symmetric);
  say("virtual couplings");
  out["filter"] = filter();
  say("corner and slot");
  out["corner_and_slot"] = Json::array();
  for (const CornerAndSlot& c : corner_and_slot(22))
    out["corner_and_slot"].push_back({{"contact_model", c.contact_model},
                                      {"corner_over_walls", c.corner_over_walls},
                                      {"slot_over_wall", c.slot_over_wall}});
  say("figures of merit");
  out["merits"] = Json::array();
  for (const Merit& m : contact_merits(quick ? 120 : kSteps))
    out["merits"].push_back(of(m));
  for (const Merit& m : filter_merits())
    out["merits"].push_back(of(m));
  out["voxel_edge_m"] = kEdge, out["sphere_radius_m"] = kRadius;
  return out;
}

}  // namespace
}  // namespace voxtouch::paper

int main(int argc, char** argv) {
  CLI::App app(
      "The paper's experiments on contact and coupling (Renz et al. 2001, figures 2, 3, 8, 9, 11), "
      "every contact_case of the "
      "contact\n"
      "next to the paper's two, as one JSON file; tests/experiments/report/make_report.py draws "
      "it. "
      "Seconds; no random "
      "numbers\n"
      "but one fixed seed, so bit-identical results every time. Figure 12 goes through the real "
      "ring: see "
      "make_report.py.");
  std::filesystem::path file = "paper_experiments.json";
  bool quick = false;
  app.add_option("--out", file, "File to write")->capture_default_str();
  app.add_flag("--quick", quick, "Fewer poses for the figures of merit");
  CLI11_PARSE(app, argc, argv);
  const nlohmann::json data = voxtouch::paper::all(quick);
  std::ofstream out(file);
  out << data.dump(1) << '\n';
  out.close();
  if (!out) {
    fmt::print(stderr, "error: {} could not be written: is there room, and may you write there?\n",
               file.string());
    return 1;
  }
  fmt::print("{:<72} {:>7} {:>15} {:>9} {:>6}\n", "figure of merit (median over the settings)",
             "ours", "least to most", "reference", "diff");
  for (const auto& m : data["merits"])
    fmt::print(
        "{:<72} {:>7.3f} {:>7.3f} {:>7.3f} {:>9.3f} {:>6}\n", m["what"].get<std::string>(),
        m["ours"].get<double>(), m["least"].get<double>(), m["most"].get<double>(),
        m["reference"].get<double>(),
        m["reference"] == 0.0
            ? ""
            : fmt::format("{:+.0f} %",
                          100 * (m["ours"].get<double>() / m["reference"].get<double>() - 1)));
  return 0;
}

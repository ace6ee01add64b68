// Measures the virtual tool: presses, slides, walls, tumbling, edges.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <numbers>

#include "loops.hpp"
#include "open_meshes.hpp"
#include "runs.hpp"
#include "thrown.hpp"

using namespace voxtouch::virtual_tool;

namespace {

void print_press(const PressOptions& o) {
  const PressFigures f = press(o);
  fmt::print(
      "press {:22} e {:g} mm {:g} mm deep{} | dir {:.2f} {:.2f} deg | |F| {:+.2f} % ({:+.2f} to "
      "{:+.2f}) | rest {:.4f} {:.4f} {:.4f} N | queries {:.2f} / {} | "
      "depth {:.4f} e, residual {:.4f} e | slid {} of {} | {:.1f} us\n",
      o.scene, 1e3 * o.edge, 1e3 * o.depth_m, o.turned ? " turned" : "", f.direction_median,
      f.direction_95, 100 * f.size_median, 100 * f.size_least, 100 * f.size_most, f.rest_median,
      f.rest_95, f.rest_worst, f.queries_mean, f.queries_most, f.depth_worst, f.residual_95, f.slid,
      f.places, f.frame_us);
  std::fflush(stdout);
}

void print_slide(const SlideOptions& o) {
  const SlideFigures f = slide(o);
  fmt::print(
      "slide {:10} e {:g} mm {:g} m/s mu {:g} | {:.3f} N, noise {:.3f} % | dir {:.2f} {:.2f} deg | "
      "step {:.4f} N, {:.4f} | E/FL {:+.5f} | "
      "queries {:.2f} / {} | {:.1f}, {:.1f} us\n",
      o.scene, 1e3 * o.edge, o.speed, o.friction, f.mean, 100 * f.noise, f.direction_median,
      f.direction_95, f.step_worst, f.step_over_force, f.energy_per_path, f.queries_mean,
      f.queries_most, f.frame_us, f.frame_us_999);
  std::fflush(stdout);
}

/// Which starts at thin plates are taken for one: those with the plate through the tool, and light
/// touches.
void print_starts(std::uint64_t seed) {
  using voxtouch::Vec3;
  struct Tool {
    const char* name;
    Vec3 box;
    double radius;
  };
  const Tool tools[] = {{"ball of 5 e", Vec3::Zero(), 5.0},
                        {"ball of 2.5 e", Vec3::Zero(), 2.5},
                        {"box of 4 x 6 x 15 e", Vec3(4, 6, 15), 0.0},
                        {"bar of 2 x 2 x 15 e", Vec3(2, 2, 15), 0.0}};
  for (const Tool& tool : tools)
    for (const double thick : {0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0})
      for (const bool askew : {false, true}) {
        StartOptions o{.box = tool.box,
                       .radius_edges = tool.radius,
                       .thick_edges = thick,
                       .askew = askew,
                       .seed = seed};
        const auto taken = [&](bool rim, bool turned, double from, double to) {
          o.rim = rim, o.turned = turned, o.from_edges = from, o.to_edges = to;
          const StartFigures f = starts(o);
          return fmt::format("{} of {}", f.placed, f.runs);
        };
        fmt::print(
            "starts {:20} plate {:4} e {:5} | across: {}, not turned {}; at the rim {} | touching: "
            "{}, not turned {}; at the rim {} | free by 0 to 1 e: {}\n",
            tool.name, thick, askew ? "askew" : "", taken(false, true, 0.8, 9),
            taken(false, false, 0.8, 9), taken(true, true, 0.8, 9), taken(false, true, 0, 0.25),
            taken(false, false, 0, 0.25), taken(true, true, 0, 0.25), taken(false, true, -1, 0));
        std::fflush(stdout);
      }
}

/// Walls that a thrown mass passes, with and without latched depths of the penalty ring.
void print_thrown(std::uint64_t seed) {
  using voxtouch::contact::ContactModelKind;
  const std::pair<const char*, Holder> holders[] = {
      {"virtual tool", {std::nullopt}},
      {"original", {ContactModelKind::kOriginal}},
      {"original, nothing held", {ContactModelKind::kOriginal, false}},
      {"adapted", {ContactModelKind::kAdapted}},
      {"adapted, nothing held", {ContactModelKind::kAdapted, false}},
      {"field", {ContactModelKind::kField}},
      {"field, nothing held", {ContactModelKind::kField, false}}};
  for (const auto& [name, holder] : holders)
    for (const double thick : {0.0, 0.5, 1.0, 2.0, 5.0, 20.0}) {
      if (thick == 0.0 && holder.model == ContactModelKind::kField)
        continue;  // without an inside
      ThrowFigures all;
      for (const bool askew : {false, true}) {
        const ThrowFigures f =
            thrown({.holder = holder, .thick_edges = thick, .askew = askew, .seed = seed});
        all.runs += f.runs, all.passed += f.passed;
        all.direction_95 = std::max(all.direction_95, f.direction_95);
      }
      fmt::print("thrown {:24} wall {:4} e | passed {} of {} | dir 95 % {:.1f} deg\n", name, thick,
                 all.passed, all.runs, all.direction_95);
      std::fflush(stdout);
    }
}

/// Open and irregular meshes that stop a ball.
void print_open(std::uint64_t seed, int places) {
  DriveFigures all;
  for (const char* const shape : open_shapes()) {
    for (const double radius : {5.0, 2.5})
      for (const bool askew : {false, true}) {
        const DriveFigures f =
            drive({.shape = shape, .radius_edges = radius, .askew = askew, .seed = seed});
        all.runs += f.runs, all.passed += f.passed, all.rims += f.rims;
        fmt::print(
            "open {:9} ball of {} e {:5} | passed {} of {}, at a rim {} | touched {} | into the "
            "ball {:.3f} e | rest 95 % {:.4f}, worst {:.4f} N\n",
            shape, radius, askew ? "askew" : "", f.passed, f.runs, f.rims, f.touched, f.into_worst,
            f.rest_95, f.rest_worst);
        std::fflush(stdout);
      }
    print_press(
        {.scene = std::string("open:") + shape, .places = places, .turned = true, .seed = seed});
  }
  fmt::print("open: passed {} of {}, at a rim {}\n", all.passed, all.runs, all.rims);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures the virtual tool"};
  std::string what = "all";
  std::uint64_t seed = 1;
  int places = 60;
  app.add_option("what", what,
                 "press, plates, corners, slide, friction, walls, starts, thrown, open, tumble, "
                 "edge, stability, torque or all");
  app.add_option("--seed", seed, "of the random places");
  app.add_option("--places", places, "of each press");
  CLI11_PARSE(app, argc, argv);
  fmt::print("seed {}\n", seed);
  const bool all = what == "all";
  if (all || what == "press") {
    for (const double e : {0.002, 0.001})
      for (const char* scene : {"plane", "tilted", "cylinder", "cylinder:384", "cup"})
        for (const bool turned : {false, true})
          print_press(
              {.scene = scene, .edge = e, .places = places, .turned = turned, .seed = seed});
  }
  if (all || what == "press" || what == "corners") {
    for (const double e : {0.002, 0.001}) {
      for (const double depth : {0.003, 0.007})
        for (const bool turned : {false, true})
          print_press({.scene = "edge",
                       .edge = e,
                       .depth_m = depth,
                       .places = places,
                       .turned = turned,
                       .seed = seed});
      for (const bool turned : {false, true})
        print_press(
            {.scene = "corner", .edge = e, .places = places, .turned = turned, .seed = seed});
    }
  }
  if (all || what == "press" || what == "plates") {
    for (const double e : {0.002, 0.001})
      for (const char* scene :
           {"plate:0.002", "plate:0.0005", "plate:0.002:askew", "plate:0.0005:askew",
            "plate:0.0025:askew", "plate:0", "plate:0:askew"})
        for (const bool turned : {false, true})
          print_press(
              {.scene = scene, .edge = e, .places = places, .turned = turned, .seed = seed});
  }
  if (all || what == "slide") {
    for (const double e : {0.002, 0.001})
      for (const char* scene : {"plane", "tilted", "cylinder"})
        for (const double speed : {0.05, 0.5})
          print_slide({.scene = scene, .edge = e, .speed = speed, .seed = seed});
  }
  if (all || what == "slide" || what == "friction") {
    for (const char* scene : {"plane", "tilted", "cylinder"})
      print_slide({.scene = scene, .friction = 0.4, .seed = seed});
  }
  if (all || what == "walls") {
    int runs = 0, passed = 0;
    for (const double thick : {0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0})
      for (const bool askew : {false, true}) {
        const WallFigures f = walls({.thick_edges = thick, .askew = askew, .seed = seed});
        runs += f.runs, passed += f.passed;
        fmt::print(
            "wall {:4} e {:5} | passed {} of {} | depth {:.3f} e | rest {:.4f} {:.4f} "
            "{:.4f} N | queries {:.2f}\n",
            thick, askew ? "askew" : "", f.passed, f.runs, f.depth_worst, f.rest_median, f.rest_95,
            f.rest_worst, f.queries_mean);
        std::fflush(stdout);
      }
    fmt::print("walls: passed {} of {}\n", passed, runs);
  }
  if (all || what == "starts")
    print_starts(seed);
  if (all || what == "thrown")
    print_thrown(seed);
  if (all || what == "open")
    print_open(seed, places);
  if (all || what == "tumble") {
    for (const double e : {0.002, 0.001})
      for (const bool box : {false, true})
        for (const double speed : {1.0, 3.0}) {
          const TumbleFigures f =
              tumble({.box = box, .edge = e, .speed = speed, .spin = 30 * speed, .seed = seed});
          fmt::print(
              "tumble {:4} e {:g} mm {:g} m/s | contact {:.2f} lag {:.2f} | inside {} not exact {} "
              "| depth {:.3f} e | queries {:.2f} iterations {:.1f} | "
              "{:.1f} {:.1f} {:.1f} us\n",
              box ? "box" : "ball", 1e3 * e, speed, f.contact_ratio, f.not_converged_ratio,
              f.inside, f.not_exact, f.depth_worst, f.queries_mean, f.iterations_mean, f.frame_us,
              f.frame_us_999, f.frame_us_worst);
          std::fflush(stdout);
        }
  }
  if (all || what == "edge") {
    for (const double e : {0.002, 0.001})
      for (const double depth : {0.003, 0.01}) {
        const EdgeFigures f = over_edge(e, depth, 0.05, seed, 10);
        fmt::print(
            "edge e {:g} mm, {:g} mm deep | step {:.4f} N, {:.4f} of the force | mean {:.3f} N | "
            "energy {:+.3f} mJ\n",
            1e3 * e, 1e3 * depth, f.step_worst, f.step_over_force, f.force_mean, 1e3 * f.energy);
        std::fflush(stdout);
      }
  }
  if (all || what == "stability") {
    for (const double delay : {0.001, 0.002}) {
      const double linear = largest_stable_stiffness({.scene = "linear", .delay_s = delay});
      for (const char* scene : {"plane", "tilted"})
        fmt::print("stability, force {:g} ms late: {} {:.0f} N/m, linear wall {:.0f} N/m\n",
                   1e3 * delay, scene, largest_stable_stiffness({.scene = scene, .delay_s = delay}),
                   linear);
    }
  }
  if (all || what == "torque") {
    for (const double e : {0.002, 0.001}) {
      const LeverFigures f = lever(e, seed);
      fmt::print("lever e {:g} mm | torque off by {:.4f} | step {:.4f} of it\n", 1e3 * e,
                 f.torque_error, f.step_over_torque);
    }
    for (const double clearance : {2e-4, 1e-4})
      for (const double e : {0.0005, 0.001, 0.002})
        for (const bool turned : {false, true}) {
          const PegFigures f = peg(e, clearance, turned);
          fmt::print("peg clearance {:g} mm e {:g} mm {:6} | {} {:.3f} mm short | drag {:.4f} N\n",
                     1e3 * clearance, 1e3 * e, turned ? "turned" : "aside",
                     f.entered ? "in," : "OUT,", 1e3 * f.short_m, f.drag_n);
        }
    for (const double clearance : {2e-4, 1e-4})
      for (const double e : {0.0005, 0.001, 0.002})
        for (const double degrees : {3.0, 6.0, 12.0}) {
          const PinFigures f = pin(e, clearance, degrees * std::numbers::pi / 180, seed);
          fmt::print(
              "pin clearance {:g} mm e {:g} mm turned by {:g} deg | {:.4f} N m, off by {:.3f}, "
              "step {:.4f} of it\n",
              1e3 * clearance, 1e3 * e, degrees, f.torque_nm, f.torque_error, f.step_over_torque);
          std::fflush(stdout);
        }
  }
}

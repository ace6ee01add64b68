// Energy that a contact gives to a hand per closed sliding loop, for each contact model, over voxel
// size, depth and tilt.
//
//   stability_map [--out FILE.csv] [--loops N] [--seed S]        under two minutes on two cores;
//   then, to draw it: tests/experiments/stability_map/draw_map.py FILE.csv
//   deploy/pictures/stability_map.png
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <array>
#include <fstream>

#include "tests/experiments/stability_map/sliding_loop.hpp"

namespace {

using voxtouch::contact::ContactModelKind;

constexpr std::array kModels = {ContactModelKind::kOriginal, ContactModelKind::kAdapted,
                                ContactModelKind::kField};
constexpr std::array kRadii = {2.5, 5.0, 10.0, 20.0};  // the ball's radius over the voxel edge
constexpr std::array kDepths = {0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0};
constexpr std::array kTilts = {0.0, 2.0, 5.0, 10.0, 15.0, 22.5, 30.0, 45.0};

void write(std::ofstream& out, int loops, std::uint64_t seed) {
  out << "model,radius_voxels,depth_voxels,tilt_deg,energy_share,energy_per_crossing,mean_force_n,"
         "largest_step\n";
  for (const double radius : kRadii) {
    for (const double tilt : kTilts) {
      const voxtouch::sliding::Bench bench(radius, tilt);
      for (const ContactModelKind model : kModels)
        for (const double depth : kDepths) {
          const voxtouch::sliding::Created made =
              bench.worst_loop(model, depth, radius > 15.0 ? (loops + 1) / 2 : loops, seed);
          out << fmt::format("{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g}\n", name_of(model), radius,
                             depth, tilt, made.fraction, made.per_crossing, made.mean_force_n,
                             made.largest_step);
        }
    }
    fmt::print(stderr, "R/e = {}: done\n", radius);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Energy created per closed sliding loop over voxel size, depth and tilt, as CSV"};
  std::string file = "stability_map.csv";
  int loops = 2;
  std::uint64_t seed = 7;
  app.add_option("--out", file, "CSV to write")->capture_default_str();
  app.add_option("--loops", loops,
                 "loops at random places per setting, each both ways round; half at R/e = 20")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--seed", seed, "of the places")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::ofstream out(file);
  write(out, loops, seed);
  out.close();
  if (out)
    return 0;
  fmt::print(stderr, "stability_map: {} cannot be written\n", file);
  return 1;
}

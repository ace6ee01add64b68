// Accuracy of the identification on random and faulty devices, compared with the required limits.
// Writes a page.
#include <fmt/chrono.h>
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <future>
#include <thread>

#include "tests/support/identification/population.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::testing;

/// Calls `run(0)` to `run(count - 1)` in `threads` threads and shows progress on stderr.
void in_parallel(const char* name, int count, int threads, const std::function<void(int)>& run) {
  std::atomic<int> next{0}, done{0};
  std::vector<std::future<void>> workers;
  for (int t = 0; t < threads; ++t)
    workers.push_back(std::async(std::launch::async, [&] {
      for (int i = next++; i < count; i = next++) {
        run(i);
        if (const int now = ++done; now % 20 == 0 || now == count)
          fmt::print(stderr, "{}: {} of {}\n", name, now, count);
      }
    }));
  for (auto& worker : workers)
    worker.get();
}

/// Coulomb friction at rest and bias, over the allowed force.
double static_friction_ratio(const AxisRun& run) {
  const AxisTruth& t = run.truth;
  return ((1.0 + t.stribeck) * t.coulomb_n + std::abs(t.bias_n)) / run.allowed_force_n;
}

struct Population {
  Counts counts;
  int allowed = 0, allowed_measured = 0;  ///< static friction below 0.6 of the allowed force
};

/// One axis of each random device.
Population population(const char* name, int devices, std::uint64_t seed, Family family,
                      int threads) {
  std::mt19937_64 random(seed);
  std::vector<std::pair<AxisTruth, std::uint64_t>> drawn;
  for (int i = 0; i < devices; ++i) {
    const AxisTruth truth = random_device(random, family)[0];
    drawn.emplace_back(truth, random());
  }
  std::vector<AxisRun> runs(drawn.size());
  in_parallel(name, devices, threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    runs[at] = identify_axis(drawn[at].first, drawn[at].second);
  });
  Population out;
  for (const AxisRun& run : runs) {
    out.counts.add(run, family == Family::kRigid ? 0.02 : 0.05);
    if (static_friction_ratio(run) > identification::kMostFrictionRatio)
      continue;
    ++out.allowed;
    out.allowed_measured += run.figures.outcome == identification::Outcome::kMeasured;
  }
  return out;
}

/// The rows of the page and how many limits are missed.
class Page {
 public:
  void line(const std::string& text) { text_ += text + "\n"; }
  void heading(const std::string& text) {
    line("\n## " + text + "\n\n| figure | measured | limit | |\n|---|---|---|---|");
  }
  void at_least(const std::string& name, int part, int all, double percent) {
    const double measured = ratio(part, all);
    row(name, fmt::format("{:.1f} % of {}", measured, all), fmt::format(">= {} %", percent),
        measured >= percent);
  }
  void at_most(const std::string& name, int part, int all, double percent) {
    const double measured = ratio(part, all);
    row(name, fmt::format("{:.2f} % of {}", measured, all), fmt::format("<= {} %", percent),
        measured <= percent);
  }
  void between(const std::string& name, int part, int all, double low, double high) {
    const double measured = ratio(part, all);
    row(name, fmt::format("{:.1f} %", measured), fmt::format("{} to {} %", low, high),
        measured >= low && measured <= high);
  }
  void width(const std::string& name, double measured, double limit, const char* unit) {
    row(name, fmt::format("{:.3g} {}", measured, unit), fmt::format("<= {} {}", limit, unit),
        measured <= limit);
  }
  void without_limit(const std::string& name, int part, int all) {
    line(fmt::format("| {} | {:.1f} % of {} | none | |", name, ratio(part, all), all));
  }
  int missed() const { return missed_; }
  int limits() const { return limits_; }
  const std::string& text() const { return text_; }

 private:
  static double ratio(int part, int all) { return all > 0 ? 100.0 * part / all : 0.0; }
  void row(const std::string& name, const std::string& measured, const std::string& limit,
           bool met) {
    ++limits_;
    missed_ += !met;
    line(fmt::format("| {} | {} | {} | {} |", name, measured, limit, met ? "met" : "**missed**"));
  }
  std::string text_;
  int missed_ = 0, limits_ = 0;
};

void accuracy(Page& page, const Counts& c, double others) {
  page.at_least("viscous within 0.1 Ns/m or 10 %", c.viscous, c.measured, others);
  page.at_least("delay within 0.1 ms or T/10, reserve of 1 m/s2", c.delay, c.reserve,
                others < 99.0 ? others : 95.0);
}

void rigid(Page& page, const Counts& c) {
  page.heading("Rigid devices: presliding 20 um, force lag, jitter 20 %, 1 % lost");
  page.at_least("measured", c.measured, c.axes, 97.0);
  page.at_most("healthy devices stopped by a rule", c.stopped, c.axes, 1.0);
  page.at_least("mass within 2 %", c.mass, c.measured, 99.0);
  page.at_least("Coulomb within 0.02 N or 10 %", c.coulomb, c.measured, 99.0);
  accuracy(page, c, 99.0);
  page.at_least("encoder step exact", c.step, c.measured, 100.0);
  page.at_most("false alarms of modes", c.false_alarms, c.measured, 2.0);
  static constexpr std::array kFigures{"mass", "viscous", "Coulomb", "bias", "delay"};
  for (std::size_t k = 0; k < kFigures.size(); ++k)
    page.between(fmt::format("interval holds the {}", kFigures[k]), c.covered[k], c.measured, 93.0,
                 99.0);
  page.width("median half width, mass", 1e2 * c.median_half_width(0), 1.0, "%");
  page.width("median half width, viscous", c.median_half_width(1), 0.03, "Ns/m");
  page.width("median half width, Coulomb", 1e3 * c.median_half_width(2), 1.0, "mN");
  page.width("median half width, delay", 1e3 * c.median_half_width(4), 0.1, "ms");
}

void faults(Page& page, int devices, std::uint64_t seed, int threads) {
  static constexpr std::array kFaults{AxisFault::kWrongSign, AxisFault::kRunaway,
                                      AxisFault::kStuck,     AxisFault::kClockStops,
                                      AxisFault::kNotFinite, AxisFault::kForceTenfold};
  static constexpr std::array kNames{"wrong sign",  "runaway", "stuck axis",
                                     "clock stops", "NaN",     "force tenfold"};
  struct Drawn {
    AxisTruth truth;
    double at_s;
    std::uint64_t seed;
  };
  std::mt19937_64 random(seed);
  std::vector<Drawn> drawn;
  for (int i = 0; i < devices; ++i) {
    const AxisTruth truth = random_device(random, Family::kRigid)[0];
    const double at = std::uniform_real_distribution<double>(0.0, 15.0)(random);
    drawn.push_back({truth, at, random()});
  }
  std::vector<FaultRun> runs(drawn.size());
  in_parallel("faulty", devices, threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    runs[at] =
        run_fault(drawn[at].truth, kFaults[at % kFaults.size()], drawn[at].at_s, drawn[at].seed);
  });
  int left = 0, late = 0, over = 0;
  std::string rows;
  for (std::size_t kind = 0; kind < kFaults.size(); ++kind) {
    std::vector<double> energy, time;
    int stopped = 0, late_here = 0;
    for (std::size_t i = kind; i < runs.size(); i += kFaults.size()) {
      stopped += runs[i].stopped;
      over += runs[i].over_force;
      energy.push_back(runs[i].energy_j);
      if (!runs[i].left_bounds)
        continue;
      time.push_back(runs[i].time_to_zero_s);
      late_here += runs[i].time_to_zero_s > runs[i].time_limit_s;
    }
    left += static_cast<int>(time.size());
    late += late_here;
    std::ranges::sort(energy);
    if (energy.empty())
      continue;
    rows += fmt::format("| {} | {} | {} | {} | {} | {:.2f} | {:.3f} | {:.3f} |\n", kNames[kind],
                        energy.size(), stopped, time.size(), late_here,
                        time.empty() ? 0.0 : 1e3 * std::ranges::max(time),
                        energy[energy.size() * 95 / 100], energy.back());
  }
  page.heading("Faulty devices with an honest encoder and clock");
  page.at_most("zero force later than 2.4 T + delay + 4 ms after leaving the box", late, left, 0.0);
  page.at_most("commands over the allowed force", over, devices, 0.0);
  page.line(
      "\nEnergy: what the motor gives from the fault to the stop. `left`: left the box.\n\n"
      "| fault | runs | stopped | left | late | slowest [ms] | 95 % [J] | largest [J] |\n"
      "|---|---|---|---|---|---|---|---|\n" +
      rows);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What identification reaches on random devices (one axis each) and on faulty ones.");
  int devices = 500, other = 500, faulty = 10'000;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::uint64_t seed = 1;
  std::string out;
  app.add_option("--devices", devices, "Rigid devices")->capture_default_str();
  app.add_option("--others", other, "Devices with Stribeck friction, and with a mode")
      ->capture_default_str();
  app.add_option("--faulty", faulty, "Faulty devices")->capture_default_str();
  app.add_option("--seed", seed, "Of the random devices")->capture_default_str();
  app.add_option("--threads", threads, "At once")->capture_default_str()->check(CLI::Range(1, 256));
  app.add_option("--out", out, "Writes the page here, else to stdout");
  CLI11_PARSE(app, argc, argv);
  Page page;
  rigid(page, population("rigid", devices, seed, Family::kRigid, threads).counts);
  const Population at_rest = population("Stribeck", other, seed + 1, Family::kStribeck, threads);
  const Counts& stribeck = at_rest.counts;
  page.heading("The same with Stribeck friction (+50 % below 5 mm/s)");
  page.without_limit("measured", stribeck.measured, stribeck.axes);
  page.at_least("measured, of those whose friction at rest is below 0.6 of the force",
                at_rest.allowed_measured, at_rest.allowed, 97.0);
  page.at_least("mass within 5 %", stribeck.mass, stribeck.measured, 99.0);
  accuracy(page, stribeck, 80.0);
  const Counts mode = population("mode", other, seed + 2, Family::kMode, threads).counts;
  page.heading("Devices with a structural mode of 25 to 180 Hz");
  page.at_least("mass within 5 %", mode.mass, mode.measured, 95.0);
  page.at_least("modes below 90 Hz found", mode.low_found, mode.low_modes, 80.0);
  faults(page, faulty, seed + 3, threads);
  const std::string text = fmt::format(
      "# Identification of random devices\n\n{}\n\n"
      "Command: `build/bin/identification_table --devices {} --others {} --faulty {} --seed {}\n"
      "--out deploy/results/identification.md` (built by `deploy/build identification_table`).\n\n"
      "{:%Y-%m-%d}, {} shared cores.\nThe full size is 500, 500 and 10000; one axis a device. The "
      "plants are not "
      "the model of the fit.\n{}",
      page.missed() == 0 ? "PASSED"
                         : fmt::format("FAILED ({} of {} limits)", page.missed(), page.limits()),
      devices, other, faulty, seed, fmt::gmtime(std::time(nullptr)),
      std::thread::hardware_concurrency(), page.text());
  std::FILE* file = out.empty() ? stdout : std::fopen(out.c_str(), "w");
  if (file == nullptr) {
    fmt::print(stderr, "{} cannot be written\n", out);
    return 2;
  }
  fmt::print(file, "{}", text);
  if (!out.empty())
    std::fclose(file);
  return page.missed() == 0 ? 0 : 1;
}

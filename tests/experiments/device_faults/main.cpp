// device_faults: injects each fault of an emulator into its driver; prints the driver's errors and
// the plant's forces.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "tests/unit/driver_contract/faults.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::contract;

struct Options {
  std::vector<std::string> only;
  bool json = false, real_time = false;
  std::string csv_file;
};

std::string device_of(const FaultCase& fault) {
  return fault.plant == Plant::kPhantom ? "phantom" : fault.plant == Plant::kLwr ? "lwr" : "fr3";
}

bool expected(const Options& o, const FaultCase& fault) {
  for (const std::string& name : o.only)
    if (name == fault.name || name == device_of(fault))
      return true;
  return o.only.empty();
}

FaultOutcome run(const FaultCase& fault, bool virtual_time) {
  const auto subject = fault.plant == Plant::kPhantom ? phantom("premium", virtual_time)
                       : fault.plant == Plant::kLwr   ? lwr(virtual_time)
                                                      : fr3(virtual_time);
  return run_fault(*subject, fault);
}

std::string reported(const FaultOutcome& o) {
  std::string text;
  for (const devices::DeviceError error : o.reported)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", devices::name_of(error));
  return text.empty() ? "-" : text;
}

std::string ms(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.1f}", 1e3 * *seconds) : "-";
}

std::string verdict(const FaultOutcome& o) {
  if (!o.good())
    return "BAD";
  const bool milder = o.fault->after == After::kRidesThrough && o.after == After::kRecovers;
  return o.fault->after == o.after || milder ? "good" : "good, but not as expected";
}

nlohmann::json to_json(const FaultOutcome& o) {
  const auto in_ms = [](const std::optional<double>& s) {
    return s ? nlohmann::json(1e3 * *s) : nlohmann::json();
  };
  std::vector<std::string> kinds;
  for (const devices::DeviceError error : o.reported)
    kinds.emplace_back(devices::name_of(error));
  return {{"device", device_of(*o.fault)},
          {"fault", o.fault->name},
          {"time", o.virtual_time ? "virtual" : "real"},
          {"period_ms", 1e3 * o.period_s},
          {"force_before_n", o.before_n},
          {"errors", kinds},
          {"told_after_ms", in_ms(o.reported_after_s)},
          {"zero_after_ms", in_ms(o.zero_after_s)},
          {"bound_ms", 1e3 * o.bound_s},
          {"bound_reason", o.fault->why},
          {"largest_force_n", o.largest_n},
          {"largest_torque_nm", o.largest_nm},
          {"after", name_of(o.after)},
          {"sentence", o.sentence},
          {"good", o.good()}};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

void write_csv(const std::string& file, const std::vector<FaultOutcome>& outcomes) {
  std::ofstream out(file);
  out << "device,fault,time,period_ms,force_before_n,errors,told_after_ms,zero_after_ms,bound_ms,"
         "largest_force_n,"
         "largest_torque_nm,"
         "after,verdict,sentence\n";
  for (const FaultOutcome& o : outcomes)
    out << fmt::format("{},{},{},{:.3f},{:.4f},{},{},{},{:.3f},{:.9g},{:.9g},{},{},{}\n",
                       device_of(*o.fault), o.fault->name, o.virtual_time ? "virtual" : "real",
                       1e3 * o.period_s, o.before_n, quoted(reported(o)), ms(o.reported_after_s),
                       ms(o.zero_after_s), 1e3 * o.bound_s, o.largest_n, o.largest_nm,
                       name_of(o.after), quoted(verdict(o)), quoted(o.sentence));
  out.flush();
  if (!out)
    throw std::runtime_error(fmt::format("'{}' cannot be written", file));
}

void print(const std::vector<FaultOutcome>& outcomes) {
  fmt::print("{:8} {:15} {:7} {:>6} {:24} {:>8} {:>8} {:>9} {:>9} {:>9} {:14} {}\n", "device",
             "fault", "time", "push N", "errors", "reported ms", "zero ms", "within ms", "then N",
             "then Nm", "then", "verdict");
  for (const FaultOutcome& o : outcomes)
    fmt::print("{:8} {:15} {:7} {:6.2f} {:24} {:>8} {:>8} {:9.1f} {:9.3g} {:9.3g} {:14} {}\n",
               device_of(*o.fault), o.fault->name, o.virtual_time ? "virtual" : "real", o.before_n,
               reported(o), ms(o.reported_after_s), ms(o.zero_after_s), 1e3 * o.bound_s,
               o.largest_n, o.largest_nm, name_of(o.after), verdict(o));
  fmt::print("\nWhat the driver said first, and why a bound is longer than one period:\n");
  for (const FaultOutcome& o : outcomes) {
    fmt::print("{} {}: {}\n", device_of(*o.fault), o.fault->name,
               o.sentence.empty() ? "-" : o.sentence);
    if (!o.fault->why.empty())
      fmt::print("    ({})\n", o.fault->why);
  }
}

int run_all(const Options& o) {
  std::vector<FaultOutcome> outcomes;
  for (const bool virtual_time : {true, false})
    for (const FaultCase& fault : fault_cases())
      if (expected(o, fault) && (virtual_time || o.real_time))
        outcomes.push_back(run(fault, virtual_time));
  if (outcomes.empty())
    throw std::runtime_error("no fault of that name");
  if (!o.csv_file.empty())
    write_csv(o.csv_file, outcomes);
  if (o.json) {
    nlohmann::json all = nlohmann::json::array();
    for (const FaultOutcome& outcome : outcomes)
      all.push_back(to_json(outcome));
    fmt::print("{}\n", all.dump(2));
  } else {
    print(outcomes);
  }
  int bad = 0;
  for (const FaultOutcome& outcome : outcomes)
    bad += !outcome.good();
  if (bad)
    fmt::print(stderr, "{} of {} faults: force that should not be\n", bad, outcomes.size());
  return bad ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Every fault of the simulated emulators, into the drivers; exit status 1 where force was "
      "received that should "
      "not be");
  Options options;
  app.add_option("--only", options.only, "Faults by name, or all of a device: phantom, lwr, fr3");
  app.add_flag("--json", options.json, "JSON instead of a table");
  app.add_option("--csv", options.csv_file, "The table to this file as well");
  app.add_flag("--real-time", options.real_time,
               "Once more in real time, where what this machine does meanwhile is seen too");
  CLI11_PARSE(app, argc, argv);
  try {
    return run_all(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "device_faults: {}\n", error.what());
    return 2;
  }
}

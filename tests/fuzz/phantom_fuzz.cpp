// Values of the vendor's library, through session, servo half and driver of the Phantom: an
// accepted sample is finite, and output is finite and within the limits of the driver's
// description.
#include "devices/limits.hpp"
#include "devices/phantom/phantom_driver.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hd_stub.hpp"

namespace {

using namespace voxtouch;

phantom::PhantomOptions options() {
  phantom::PhantomOptions o;
  o.library = VOXTOUCH_FUZZ_HD_STUB;
  o.calibration_timeout_s = 1e-6;
  o.silence_s = 60.0;
  return o;
}

void check(const DeviceDescription& d) {
  FUZZ_REQUIRE(d.max_force_n > 0.0 && std::isfinite(d.max_force_n));
  FUZZ_REQUIRE(d.max_torque_nm >= 0.0 && std::isfinite(d.max_torque_nm));
  FUZZ_REQUIRE(d.rate_hz >= 400.0 && d.rate_hz <= 9000.0 &&
               std::isfinite(d.max_force_rate_n_per_s));
  FUZZ_REQUIRE(d.max_stiffness_n_per_m > 0.0 && std::isfinite(d.max_stiffness_n_per_m));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz_hd_say(data, size);
  try {
    phantom::PhantomDriver driver(options());
    const DeviceDescription& d = driver.description();
    check(d);
    for (int n = 0; n < 40; ++n) {
      fuzz_hd_tick();
      const auto sample = driver.read(std::chrono::microseconds(0));
      if (!sample && driver.servo().errors().fatal() != phantom::hd::kSuccess)
        break;
      if (sample && sample->pose_valid) {
        FUZZ_REQUIRE(sample->pose.finite() &&
                     std::abs(sample->pose.orientation.norm() - 1.0) < 1e-6);
        FUZZ_REQUIRE(sample->twist.finite());
      }
      (void)driver.write(
          {Vec3(0.0, 0.99 * d.max_force_n, 0.0), Vec3(0.0, 0.0, 0.99 * d.max_torque_nm)});
      double force[3], torque_mnm[3];
      FUZZ_REQUIRE(fuzz_hd_last(force, torque_mnm));
      FUZZ_REQUIRE(length_of(Vec3(force[0], force[1], force[2])) <= d.max_force_n);
      FUZZ_REQUIRE(1e-3 * length_of(Vec3(torque_mnm[0], torque_mnm[1], torque_mnm[2])) <=
                   d.max_torque_nm * (1.0 + 1e-12));
    }
    (void)driver.last_error();
  } catch (const devices::DeviceOpenError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with("device 'phantom'"));
  }
  return 0;
}

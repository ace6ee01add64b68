#pragma once
/// A driver, the plant behind it, and a record of what the plant received: the interface of the
/// contract tests to a device.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/driver.hpp"
#include "tests/unit/driver_contract/faults.hpp"

namespace voxtouch::contract {

/// Force of the plant's motors over one period of the driver, on the plant's clock. The plants of
/// the contract add no delay and no lag, so any delay is that of the driver and its protocol.
struct Received {
  double begin_s = 0.0, end_s = 0.0;
  Wrench wrench;  ///< at the tool, axes of D
};

/// Output of the driver, observed outside of it: at the vendor's function, or in the datagram.
struct Wire {
  std::uint64_t orders = 0;               ///< outputs that could contain a force
  std::uint64_t pushes = 0;               ///< that did
  std::uint64_t not_finite = 0;           ///< with any number that is none
  double force_n = 0.0, torque_nm = 0.0;  ///< the largest
  double drive_ratio = 0.0;  ///< the largest joint torque, as a fraction of the permitted one
};

/// One device, its clock and its ears. The thread that makes it owns it; the plant may run on
/// another.
class Subject {
 public:
  virtual ~Subject() = default;

  /// Before `open`. At most one.
  void plan(const FaultCase& fault) { fault_ = &fault; }
  /// Throws DeviceOpenError.
  void open();
  /// Destroys the driver; the plant lives as long as its time.
  void close() { driver_.reset(); }
  devices::Driver& driver() { return *driver_; }
  bool opened() const { return driver_ != nullptr; }

  struct Cycle {
    devices::DeviceResult<devices::DeviceSample> sample;
    devices::DeviceResult<void> written;
    double time_s = 0.0;     ///< plant time of the write
    std::string last_error;  ///< as another thread would read it between the two; after a planned
                             ///< fault has begun
  };
  /// One period of a loop without recovery: it writes for any result of `read`, unless `command` is
  /// absent.
  Cycle cycle(const std::optional<Wrench>& command);
  /// Writes `command` until the plant gives it. False: it never did.
  bool push_until_measured(const Wrench& command, double tolerance = 0.1);

  struct Another {
    std::unique_ptr<devices::Driver> driver;  ///< null: it was refused
    std::string sentence;
  };
  /// A second driver at the same device while the first is open.
  virtual Another open_another();

  /// Everything so far, in order.
  const std::vector<Received>& received();
  /// When the planned fault began, on the plant's clock; absent: not yet.
  std::optional<double> fault_began_s() const { return began_s_; }

  virtual std::string name() const = 0;
  virtual bool virtual_time() const { return true; }
  /// Two of them cannot be open at a time.
  virtual bool exclusive() const { return true; }
  /// The plant's clock [s].
  virtual double now_s() = 0;
  virtual Wire wire() = 0;
  /// A force that the device can display for seconds.
  virtual Wrench usual_push() const = 0;
  /// Time that the usual force takes to end: 0 unless the device limits the rate of its torques.
  virtual double fade_s() const { return 0.0; }
  /// Number of periods until a command is reached: 1 unless the device limits the rate of its
  /// torques.
  virtual int periods_to_reach() const { return 1; }
  /// Tolerance for a busy machine and for the device; in virtual time for the device only.
  double slack_s() const { return fade_s() + (virtual_time() ? 0.0 : 10.0 * usual_period_s()); }
  virtual double usual_period_s() const { return 1e-3; }
  /// An answer that was sent cannot be withdrawn.
  virtual bool answers_are_final() const { return false; }

 protected:
  virtual std::unique_ptr<devices::Driver> make() = 0;
  /// For plants with time that passes only in the driver's calls: records what they received since
  /// the last call.
  virtual void observe() {}
  /// One period without the driver, if it made none.
  virtual void pass_period() {}
  virtual void begin_fault(const FaultCase&) {}
  virtual void end_fault(const FaultCase&) {}
  /// Whether the plant has its faults from a schedule, by its own clock.
  virtual bool scheduled_faults() const { return false; }
  virtual void collect(std::vector<Received>&) {}

  const FaultCase* fault_ = nullptr;
  std::unique_ptr<devices::Driver> driver_;
  std::vector<Received> received_;

 private:
  void look_after_fault();
  std::optional<double> began_s_;
  bool ended_ = false;
};

/// Creates a subject; also twice, to test exclusive devices.
using MakeSubject = std::function<std::unique_ptr<Subject>()>;

std::unique_ptr<Subject> simulated_phantom();
std::unique_ptr<Subject> simulated_lwr();
/// At libHD_sim. `model`: a key of hdsim_set_model.
std::unique_ptr<Subject> phantom(const std::string& model, bool virtual_time);
/// At the controller in this process. `capture`: file of a pcap, empty for none.
std::unique_ptr<Subject> lwr(bool virtual_time, const std::string& capture = {});
/// The simulated Franka arm in this process; its server uses `version`.
std::unique_ptr<Subject> fr3(bool virtual_time, std::uint16_t version = 10);

/// Network output of this process, for the subjects that observe it.
void lwr_receives(const void* data, std::size_t size);
void fr3_receives(const void* data, std::size_t size);

}  // namespace voxtouch::contract

#pragma once
/// A driver, what stands behind it, and a look at what that received: all that the contract and its
/// experiments need of a device.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/driver.hpp"
#include "tests/unit/driver_contract/faults.hpp"

namespace voxtouch::contract {

/// What the plant's motors gave over one period of the driver, on the plant's own clock. The plants
/// of the contract add no delay and no lag of their own, so whatever is seen is the driver's and
/// the protocol's.
struct Received {
  double begin_s = 0.0, end_s = 0.0;
  Wrench wrench;  ///< at the tool, axes of D
};

/// What left the driver, seen from outside of it: at the vendor's function, in the datagram.
struct Wire {
  std::uint64_t orders = 0;               ///< that could have held a push
  std::uint64_t pushes = 0;               ///< that did
  std::uint64_t not_finite = 0;           ///< with any number that is none
  double force_n = 0.0, torque_nm = 0.0;  ///< the largest
  double drive_ratio =
      0.0;  ///< the largest torque of a joint, as a fraction of what one may be asked for
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
  /// The driver goes; the plant stays as long as its time does.
  void close() { driver_.reset(); }
  devices::Driver& driver() { return *driver_; }
  bool opened() const { return driver_ != nullptr; }

  struct Cycle {
    devices::DeviceResult<devices::DeviceSample> sample;
    devices::DeviceResult<void> written;
    double time_s = 0.0;     ///< of the plant, when the write came
    std::string last_error;  ///< as another thread would hear it between the two; once a planned
                             ///< fault has begun
  };
  /// One period of a loop that receives nothing: whatever `read` says, it writes, unless `command`
  /// is absent.
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
  /// A push that the device can hold for seconds.
  virtual Wrench usual_push() const = 0;
  /// How long the usual push takes to end: nothing, but where the device itself bears no steps of
  /// its torques.
  virtual double fade_s() const { return 0.0; }
  /// How many periods a command has to last to be reached, likewise.
  virtual int periods_to_reach() const { return 1; }
  /// What a machine that others use may take next to one period, and what the device does; in
  /// virtual time the latter alone.
  double slack_s() const { return fade_s() + (virtual_time() ? 0.0 : 10.0 * usual_period_s()); }
  virtual double usual_period_s() const { return 1e-3; }
  /// An answer that has gone out cannot be taken back.
  virtual bool answers_are_final() const { return false; }

 protected:
  virtual std::unique_ptr<devices::Driver> make() = 0;
  /// For plants whose time passes only in the driver's calls: what they received since the last
  /// time.
  virtual void observe() {}
  /// One period without the driver, where it made none.
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

/// Makes one; also twice, for what must not be open twice.
using MakeSubject = std::function<std::unique_ptr<Subject>()>;

std::unique_ptr<Subject> simulated_phantom();
std::unique_ptr<Subject> simulated_lwr();
/// At libHD_sim. `model`: a key of hdsim_set_model.
std::unique_ptr<Subject> phantom(const std::string& model, bool virtual_time);
/// At the controller in this process. `capture`: file of a pcap, empty for none.
std::unique_ptr<Subject> lwr(bool virtual_time, const std::string& capture = {});
/// At the simulated Franka arm in this process, whose server speaks `version`.
std::unique_ptr<Subject> fr3(bool virtual_time, std::uint16_t version = 10);

/// What this process hands to the system for the network, for the subjects that listen.
void lwr_receives(const void* data, std::size_t size);
void fr3_receives(const void* data, std::size_t size);

}  // namespace voxtouch::contract

#pragma once
/// The running coupling, published as CouplingDesign and reported in the status of the node.
#include <mutex>
#include <optional>

#include "core/device_fit/force_preview.hpp"
#include "nodes/coupling/design_message.hpp"
#include "nodes/runtime/node_host.hpp"

namespace voxtouch::coupling_node {

/// The loop calls `adopt`, `fitted` and `use`; only `adopt` locks. The monitor calls `report_to`.
class RunningDesign {
 public:
  RunningDesign(runtime::NodeHost& host, const scene::WorkspaceMapping& mapping)
      : designs_(host.writer<msg::CouplingDesign>(qos::kCouplingDesign)),
        mapping_(mapping) {}
  const bus::Writer<msg::CouplingDesign>& writer() const noexcept { return designs_; }

  /// Publishes and stores the design. `preview`: force displayed under it. `external`: see
  /// publish_design.
  void adopt(device_fit::FittedCoupling fitted, Adoption use,
             const std::optional<device_fit::ForcePreview>& preview, double device_max_n_per_m,
             const std::string& external);
  const device_fit::FittedCoupling& fitted() const noexcept { return fitted_; }
  const Adoption& use() const noexcept { return use_; }

  /// `contact_n_per_m`: largest contact stiffness so far, in W [N/m].
  void report_to(double contact_n_per_m, runtime::NodeReport& report, runtime::StatusText& status);

 private:
  void describe(runtime::NodeReport& report) const;

  bus::Writer<msg::CouplingDesign> designs_;
  const scene::WorkspaceMapping& mapping_;
  Adoption use_;
  std::mutex mutex_;
  device_fit::FittedCoupling fitted_;
  std::optional<device_fit::ForcePreview> preview_;
  double device_max_n_per_m_ = 0.0;
  std::uint64_t count_ = 0;  ///< number of adopted designs
};

}  // namespace voxtouch::coupling_node

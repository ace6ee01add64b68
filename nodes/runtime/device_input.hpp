#pragma once
/// Reads the device's description and status, for rendering and coupling.
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "nodes/runtime/device_message.hpp"
#include "nodes/runtime/node_host.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::runtime {

/// Description and status of the participant that is bound as the device. `take` and `current`
/// belong to the loop, which locks only if a description has arrived. `report_to` belongs to the
/// monitor.
class DeviceInput {
 public:
  /// `stream`: another reader of the device's topics, if there is one.
  explicit DeviceInput(NodeHost& host, bus::Following* stream = nullptr)
      : descriptions_(
            host.reader<bus::LatchedReader<msg::DeviceDescription>>(qos::kDeviceDescription)),
        binding_("device", inputs(stream)) {
    host.link_reader(qos::kDeviceDescription, descriptions_);
  }

  /// Calls f(const DeviceDescription&, session) for a new description. An invalid description is
  /// ignored.
  template <class F>
  void take(F&& f) {
    descriptions_.take([&](const msg::DeviceDescription& message) {
      const DeviceDescription device = from_msg(message);
      std::string refusal = validate(device);
      if (refusal.empty())
        f(device, message.session_id);
      const std::lock_guard lock(mutex_);
      refusal_ = std::move(refusal);
    });
  }
  /// Whether the description of the bound device has been taken.
  bool current() const noexcept { return descriptions_.current(); }
  RoleBinding& binding() noexcept { return binding_; }
  const RoleBinding& binding() const noexcept { return binding_; }

  void report_to(const NodeRegistry& registry, StatusText& status) {
    binding_.update(registry, std::nullopt);
    {
      const std::lock_guard lock(mutex_);
      if (!refusal_.empty())
        status.set(StatusPriority::kFault, "device description refused: " + refusal_);
    }
    status.set(StatusPriority::kFault, binding_.diagnostic(registry));
  }

 private:
  std::vector<bus::Following*> inputs(bus::Following* stream) {
    std::vector<bus::Following*> all{&descriptions_.following()};
    if (stream)
      all.push_back(stream);
    return all;
  }

  bus::LatchedReader<msg::DeviceDescription> descriptions_;
  RoleBinding binding_;
  std::mutex mutex_;
  std::string refusal_;  ///< reason why the last description is invalid
};

}  // namespace voxtouch::runtime

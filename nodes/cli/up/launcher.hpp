#pragma once
/// The nodes that `up` runs, as processes or as threads of this process; one interface for both.
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodes/coupling/coupling_node.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/logger/logger_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/validator/validator_node.hpp"

namespace voxtouch::cli {

/// A node that has been started.
class RunningNode {
 public:
  virtual ~RunningNode() = default;
  /// As in its status: "device", ...
  virtual const std::string& name() const noexcept = 0;
  /// Requests an orderly end (SIGTERM, or its flag); does not wait. No effect on one that has
  /// ended.
  virtual void request_stop() = 0;
  /// Exit status once it has ended (128 + signal number if one ended it); does not wait.
  virtual std::optional<int> ended() = 0;
  /// Waits, then ends it by force. Returns the exit status.
  int join(std::chrono::milliseconds patience);
  /// Of its process: this one for a thread.
  virtual std::uint32_t pid() const noexcept = 0;

 protected:
  virtual void kill() = 0;
};

/// Start options of the nodes.
struct LauncherOptions {
  device_node::Options device;
  rendering_node::Options rendering;
  coupling_node::Options coupling;
  logger::Options logger;
  validator::Options validator;
  bool record = true;
  bool one_process = false;
};

/// Starts logger, validator, coupling and rendering: all but the device. `options` must outlive the
/// members. Throws std::runtime_error if a program cannot be started.
std::vector<std::unique_ptr<RunningNode>> launch(LauncherOptions& options);
/// Starts one node, by its name, with `options` as `launch` left them. Throws as that.
std::unique_ptr<RunningNode> start_node(LauncherOptions& options, const std::string& name);

/// The page of `up --view`: `voxtouch view` as a separate process; its end does not affect the
/// ring. Displays the ring of `options` and the meshes of its scene, and prints its address on
/// stderr. `leads_hand`: pages move the hand of the ring's device. `browser`: opens the page there.
/// `choice`: file for the run that a page chooses next; empty: none. Throws std::runtime_error if
/// it cannot be started.
std::unique_ptr<RunningNode> start_page(const runtime::NodeOptions& options, bool leads_hand,
                                        bool browser, const std::filesystem::path& choice);

}  // namespace voxtouch::cli

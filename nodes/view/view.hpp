#pragma once
/// A page that shows a ring while it runs, or a recorded run.
#include <atomic>
#include <filesystem>

#include "nodes/runtime/options.hpp"
#include "nodes/view/last_seconds.hpp"
#include "nodes/view/next_ring.hpp"
#include "nodes/view/page_server.hpp"

namespace voxtouch::view {

struct Options {
  runtime::NodeOptions node;  ///< rig, domain, interface
  std::filesystem::path
      shown;  ///< a bag, a scene file, or empty: the ring's own scene, if its file is at hand
  ServerOptions server;
  bool leads_hand = false;  ///< pages move the hand of the ring's device
  bool opens_browser = false;
  /// Where a page's choice of what runs next is written to: scene, device and address of the page,
  /// a line each. Empty: pages choose nothing.
  std::filesystem::path choice;
  NextActions next;  ///< with `choice`
  SaveActions save;  ///< used if pages move the hand
  bool to_stderr =
      false;  ///< the address is printed there, since stdout belongs to another program
};

/// Status with which `run` ends once a page has chosen what runs next.
inline constexpr int kChosenStatus = 10;

/// Serves until `stop`, or until a page has chosen what runs next. Throws std::runtime_error, a
/// sentence.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::view

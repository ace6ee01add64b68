#pragma once
/// Serves a page that displays a running ring or a recorded run.
#include <atomic>
#include <filesystem>

#include "nodes/runtime/options.hpp"
#include "nodes/view/last_seconds.hpp"
#include "nodes/view/next_ring.hpp"
#include "nodes/view/page_server.hpp"

namespace voxtouch::view {

struct Options {
  runtime::NodeOptions node;    ///< rig, domain, interface
  std::filesystem::path shown;  ///< a bag, a scene file, or empty: the scene file of the ring
  ServerOptions server;
  bool leads_hand = false;  ///< pages move the hand of the ring's device
  bool opens_browser = false;
  /// File for a page's choice of the next run: scene, device and address of the page, a line each.
  /// Empty: no choice.
  std::filesystem::path choice;
  NextActions next;        ///< with `choice`
  SaveActions save;        ///< used if pages move the hand
  bool to_stderr = false;  ///< print the address to stderr; stdout belongs to another program
};

/// Return value of `run` after a page has chosen the next run.
inline constexpr int kChosenStatus = 10;

/// Serves until `stop`, or until a page has chosen the next run. Throws std::runtime_error, with a
/// sentence.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::view

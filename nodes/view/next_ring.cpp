#include "nodes/view/next_ring.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <libwebsockets.h>

#include "core/types/shipped_files.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;

std::vector<std::string> offered_devices() {
  std::vector<std::string> devices = {"sim-phantom", "sim-lwr"};
  for (const std::string& name : shipped_files("devices"))
    devices.push_back("sim:" + name);
  return devices;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Formats of one file, without references to others.
bool is_mesh_ending(const std::string& ending) {
  constexpr std::array<std::string_view, 4> kEndings = {".obj", ".stl", ".ply", ".glb"};
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

}  // namespace

json NextRing::offered() {
  return {{"scenes", shipped_files("scenes")}, {"devices", offered_devices()}};
}

bool NextRing::may_begin(const std::string& device) {
  if (checking_.valid() || chosen_)
    problem_ = "Another choice is being checked.";
  else if (!contains(offered_devices(), device))
    problem_ = "This device is not among the offered ones.";
  else
    return true;
  return false;
}

void NextRing::begin(std::function<Next()> make) {
  checking_ = std::async(std::launch::async, [this, make = std::move(make)]() -> Checked {
    try {
      Next next = make();
      actions_.check(next);
      return {std::move(next), ""};
    } catch (const std::exception& error) {
      return {{}, error.what()};
    }
  });
}

void NextRing::choose(const json& order) {
  Next next{order.at("scene").get<std::string>(), order.at("device").get<std::string>()};
  if (!may_begin(next.device))
    return;
  if (contains(shipped_files("scenes"), next.scene))
    begin([next = std::move(next)] { return next; });
  else
    problem_ = "This scene is not among the offered ones.";
}

void NextRing::take_mesh(std::uint64_t page, const json& order) {
  const auto ending = order.at("ending").get<std::string>();
  const auto device = order.at("device").get<std::string>();
  const auto at = order.at("at").get<std::size_t>(), of = order.at("of").get<std::size_t>();
  const auto data = order.at("data").get<std::string>();
  if (at == 0) {
    mesh_.clear();
    page_ = page;
  }
  if (page != page_ || at != mesh_.size())
    return;
  if (!is_mesh_ending(ending) || of > kMaxMeshBytes) {
    problem_ = fmt::format("A mesh is an OBJ, STL, PLY or GLB file of at most {} MiB.",
                           kMaxMeshBytes >> 20);
    return;
  }
  std::string piece(data.size() + 4, '\0');
  const int size =
      lws_b64_decode_string(data.c_str(), piece.data(), static_cast<int>(piece.size()));
  if (size <= 0 || mesh_.size() + static_cast<std::size_t>(size) > of)
    return;
  mesh_.append(piece, 0, static_cast<std::size_t>(size));
  if (mesh_.size() == of && may_begin(device))
    begin([this, ending, device, mesh = std::exchange(mesh_, {})] {
      return Next{actions_.propose(mesh, ending, device), device};
    });
}

std::optional<std::string> NextRing::poll() {
  if (checking_.valid() &&
      checking_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    Checked checked = checking_.get();
    if (checked.problem.empty())
      chosen_ = std::move(checked.next);
    else
      problem_ = std::move(checked.problem);
  }
  if (problem_.empty())
    return std::nullopt;
  return std::exchange(problem_, {});
}

}  // namespace voxtouch::view

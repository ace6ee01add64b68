#pragma once
/// Readers of a running ring, as best-effort taps.
#include "nodes/bus/reader.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/view/facts.hpp"
#include "nodes/view/node_table.hpp"
#include "nodes/view/picture.hpp"

namespace voxtouch::view {

class RingTap {
 public:
  RingTap(const bus::Participant& participant, const runtime::NodeOptions& options);
  /// Takes all messages since the last call, at most the last second of a stream.
  void take(Picture& picture, Facts& facts, NodeTable& nodes, std::int64_t now_ns);
  /// The scene's file, from the status of a rendering node on this host; else empty.
  std::string scene_file() const;

 private:
  runtime::NodeRegistry registry_;
  bus::Reader<msg::DeviceState> states_;
  bus::Reader<msg::ContactState> contacts_;
  bus::Reader<msg::ForceCommand> commands_;
  bus::Reader<msg::ScenePlan> plans_;
  bus::Reader<msg::CouplingDesign> designs_;
  bus::Reader<msg::DeviceDescription> devices_;
  bus::Reader<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
};

}  // namespace voxtouch::view

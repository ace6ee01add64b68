#include "nodes/bus/opaque_qos.hpp"

namespace voxtouch::bus {

EndpointQos recorder_qos(const EndpointQos& writer, std::int32_t depth) noexcept {
  EndpointQos reader;
  reader.reliability = writer.reliability;
  reader.durability = writer.durability;
  reader.history = History::kKeepLast;
  reader.depth = depth < 1 ? 1 : depth;
  return reader;
}

}  // namespace voxtouch::bus

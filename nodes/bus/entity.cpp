#include "nodes/bus/entity.hpp"

namespace voxtouch::bus {

Entity::Entity(dds_entity_t handle, const std::string& what) : handle_(handle) {
  if (handle < 0) {
    handle_ = 0;
    throw Error(what + " (DDS: " + dds_strretcode(-handle) + ")");
  }
}

Entity& Entity::operator=(Entity&& other) noexcept {
  if (this != &other) {
    if (handle_ > 0)
      dds_delete(handle_);
    handle_ = std::exchange(other.handle_, 0);
  }
  return *this;
}

Entity::~Entity() {
  if (handle_ > 0)
    dds_delete(handle_);
}

}  // namespace voxtouch::bus

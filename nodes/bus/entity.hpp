#pragma once
/// Move-only owner of a DDS handle, and the error type of endpoint creation.
#include <stdexcept>
#include <string>
#include <utility>

#include <dds/dds.h>

namespace voxtouch::bus {

/// A DDS call failed during start-up; the text is a sentence.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Deletes its entity in the destructor. Not for the loop.
class Entity {
 public:
  Entity() = default;
  /// Takes ownership of `handle`. For a negative handle throws Error with `what` and the text of
  /// the DDS return code.
  Entity(dds_entity_t handle, const std::string& what);
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept;
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  ~Entity();

  dds_entity_t get() const noexcept { return handle_; }
  explicit operator bool() const noexcept { return handle_ > 0; }

 private:
  dds_entity_t handle_ = 0;
};

}  // namespace voxtouch::bus

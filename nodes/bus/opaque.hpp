#pragma once
/// Raw CDR on any keyless DDS topic, known by name and type name only: what a recorder takes and a player
/// writes. Works against endpoints with XTypes type information and without (ROS 2), of either byte order:
/// bytes are never touched. Move-only handles over plain `dds_entity_t`; a participant outlives what is made
/// on it, a topic its readers and writers.
#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <expected>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "nodes/bus/opaque_qos.hpp"

namespace voxtouch::bus {

/// What DDS refused, as one sentence for a person, and its return code for a program.
struct OpaqueError {
  dds_return_t code = DDS_RETCODE_ERROR;
  std::string sentence;
};
template <class T>
using OpaqueResult = std::expected<T, OpaqueError>;

/// Owns one DDS entity and deletes it.
class OwnedEntity {
 public:
  OwnedEntity() = default;
  explicit OwnedEntity(dds_entity_t handle) noexcept : handle_(handle) {}
  OwnedEntity(OwnedEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  OwnedEntity& operator=(OwnedEntity&& other) noexcept {
    if (this != &other) reset(std::exchange(other.handle_, 0));
    return *this;
  }
  ~OwnedEntity() { reset(); }
  void reset(dds_entity_t handle = 0) noexcept {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = handle;
  }
  dds_entity_t get() const noexcept { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

/// A topic without type knowledge. May stand beside typed topics of the same name in the same participant.
class OpaqueTopic {
 public:
  /// `type_name` as on the wire, e.g. "voxtouch_msgs::msg::dds_::DeviceState_". Error: DDS refuses the name.
  static OpaqueResult<OpaqueTopic> create(dds_entity_t participant, const std::string& name,
                                          const std::string& type_name);
  dds_entity_t handle() const noexcept { return entity_.get(); }
  dds_entity_t participant() const noexcept { return participant_; }
  const std::string& name() const noexcept { return name_; }
  const std::string& type_name() const noexcept { return type_name_; }

 private:
  OpaqueTopic(dds_entity_t participant, OwnedEntity entity, std::string name, std::string type_name)
      : participant_(participant), entity_(std::move(entity)), name_(std::move(name)),
        type_name_(std::move(type_name)) {}
  dds_entity_t participant_;
  OwnedEntity entity_;
  std::string name_, type_name_;
};

enum class InstanceState : std::uint8_t { kAlive, kDisposed, kNoWriters };

/// One sample as it came. `bytes` live until the callback returns.
struct RawSample {
  std::span<const std::byte> bytes;  ///< encapsulation header and CDR; empty if not `valid`
  std::int64_t source_time_ns = 0;   ///< the writer's stamp, its clock
  /// wall clock of this host when the sample reached the reader's cache
  std::int64_t reception_time_ns = 0;
  std::uint64_t publication_handle = 0;  ///< DDS instance handle of the writer
  InstanceState state = InstanceState::kAlive;
  bool valid = false;  ///< false: only `state` has news (the writers are gone)
};

class OpaqueReader {
 public:
  static OpaqueResult<OpaqueReader> create(const OpaqueTopic& topic, const EndpointQos& qos,
                                           const dds_listener_t* listener = nullptr);

  /// Takes what is there, at most `max` samples, oldest first, and calls f(const RawSample&) for each. Does
  /// not block. Returns how many. f must not throw.
  template <class F>
  OpaqueResult<std::size_t> take(F&& f, std::size_t max = std::numeric_limits<std::size_t>::max()) {
    using Callback = std::remove_reference_t<F>;
    const Each each = [](void* context, const RawSample& sample) { (*static_cast<Callback*>(context))(sample); };
    return take_each(each, const_cast<void*>(static_cast<const void*>(std::addressof(f))), max);
  }

  /// Writers matched now; 0 if asking fails.
  std::size_t matched_writers() const noexcept;
  /// For waitsets and listeners of others.
  dds_entity_t handle() const noexcept { return entity_.get(); }

 private:
  explicit OpaqueReader(OwnedEntity entity) : entity_(std::move(entity)) {}
  using Each = void (*)(void*, const RawSample&);
  OpaqueResult<std::size_t> take_each(Each each, void* context, std::size_t max);
  OwnedEntity entity_;
};

class OpaqueWriter {
 public:
  static OpaqueResult<OpaqueWriter> create(const OpaqueTopic& topic, const EndpointQos& qos);

  /// Writes a message, encapsulation header included, with `source_time_ns` >= 0 as its stamp. May block up
  /// to the QoS's max_blocking_ns when reliable. Errors: too short for a header, negative time, no room in
  /// time.
  OpaqueResult<void> write(std::span<const std::byte> bytes, std::int64_t source_time_ns);
  OpaqueResult<void> write(std::span<const std::byte> bytes) { return write(bytes, dds_time()); }

  std::size_t matched_readers() const noexcept;
  dds_entity_t handle() const noexcept { return entity_.get(); }

 private:
  OpaqueWriter(OwnedEntity entity, std::string topic) : entity_(std::move(entity)), topic_(std::move(topic)) {}
  OwnedEntity entity_;
  std::string topic_;
};

}  // namespace voxtouch::bus

#pragma once
/// A typed DDS writer.
#include "nodes/bus/endpoint.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

template <class T>
class Writer {
 public:
  Writer() = default;
  Writer(const Participant& participant, const qos::Topic& row, std::string_view rig,
         const qos::Profile& profile)
      : entities_(make_writer(participant, row, rig, profile, msg::kAnyType<T>)) {}

  /// Returns false if DDS did not accept the sample (a bounded history stayed full for 100 ms).
  bool write(const T& sample) noexcept {
    return dds_write(entities_.endpoint.get(), &sample) == DDS_RETCODE_OK;
  }
  /// For lockstep, where no sample may be lost: retries while a reader keeps the history full.
  /// Calls `give_up` ten times a second and stops when it returns true.
  template <class GiveUp>
  bool write_until(const T& sample, GiveUp give_up) noexcept {
    for (;;) {
      const dds_return_t taken = dds_write(entities_.endpoint.get(), &sample);
      if (taken != DDS_RETCODE_TIMEOUT || give_up())
        return taken == DDS_RETCODE_OK;
    }
  }
  /// Waits until every matched reliable reader has acknowledged all samples. Returns false on
  /// time-out.
  bool wait_for_acknowledgments(dds_duration_t timeout) noexcept {
    return dds_wait_for_acks(entities_.endpoint.get(), timeout) == DDS_RETCODE_OK;
  }
  std::vector<Guid> matched() const { return matched_readers(entities_.endpoint.get()); }
  /// Number of matched readers; real-time safe.
  std::uint32_t matched_count() const noexcept { return matches().current_count; }
  /// Number of readers matched since creation, including departed ones; real-time safe.
  std::uint32_t ever_matched() const noexcept { return matches().total_count; }
  explicit operator bool() const noexcept { return static_cast<bool>(entities_.endpoint); }
  /// Handle by which readers of this process identify its samples.
  dds_instance_handle_t handle() const noexcept {
    dds_instance_handle_t handle = 0;
    dds_get_instance_handle(entities_.endpoint.get(), &handle);
    return handle;
  }

 private:
  dds_publication_matched_status_t matches() const noexcept {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(entities_.endpoint.get(), &status);
    return status;
  }

  EndpointEntities entities_;
};

}  // namespace voxtouch::bus

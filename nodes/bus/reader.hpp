#pragma once
/// A typed DDS reader.
#include <cassert>
#include <limits>
#include <type_traits>

#include "nodes/bus/endpoint.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

template <class T>
class Reader {
 public:
  Reader() = default;
  Reader(const Participant& participant, const qos::Topic& row, std::string_view rig,
         const qos::Profile& profile, Following* following = nullptr)
      : entities_(make_reader(participant, row, rig, profile, msg::kAnyType<T>, following)),
        unread_(dds_create_readcondition(entities_.endpoint.get(), DDS_ANY_STATE),
                "cannot create a read condition") {}

  /// Takes the oldest waiting sample, if any, into `sample`. `writer` (optional) receives the
  /// handle of its writer. Only for fixed-size types. Real-time safe apart from the DDS call.
  bool take(T& sample, dds_instance_handle_t* writer = nullptr) noexcept {
    assert(msg::Type<T>::descriptor->m_flagset & DDS_TOPIC_FIXED_SIZE &&
           "strings and sequences would never be freed: take_each");
    void* slot[1] = {&sample};
    dds_sample_info_t info;
    while (dds_take(entities_.endpoint.get(), slot, &info, 1, 1) == 1) {
      if (!info.valid_data)
        continue;  // only a writer that appeared or left
      if (writer)
        *writer = info.publication_handle;
      return true;
    }
    return false;
  }
  /// Calls f(const T&), f(const T&, writer handle) or f(const T&, const dds_sample_info_t&) for
  /// each waiting sample, oldest first. At most `most` samples are taken. For types with strings
  /// and sequences, whose memory belongs to DDS. Returns the number of samples.
  template <class F>
  int take_each(F&& f, int most = std::numeric_limits<int>::max()) {
    int count = 0;
    while (count < most) {
      void* lent[1] = {nullptr};
      dds_sample_info_t info;
      const auto n = dds_take(entities_.endpoint.get(), lent, &info, 1, 1);
      if (n <= 0)
        return count;
      if (info.valid_data) {
        if constexpr (std::is_invocable_v<F, const T&, dds_instance_handle_t>)
          f(*static_cast<const T*>(lent[0]), info.publication_handle);
        else if constexpr (std::is_invocable_v<F, const T&, const dds_sample_info_t&>)
          f(*static_cast<const T*>(lent[0]), info);
        else
          f(*static_cast<const T*>(lent[0]));
        ++count;
      }
      dds_return_loan(entities_.endpoint.get(), lent, n);
    }
    return count;
  }
  std::vector<Guid> matched() const { return matched_writers(entities_.endpoint.get()); }
  std::vector<dds_instance_handle_t> writer_handles() const {
    return matched_writer_handles(entities_.endpoint.get());
  }
  /// Number of matched writers; real-time safe.
  std::uint32_t matched_count() const noexcept {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(entities_.endpoint.get(), &status);
    return status.current_count;
  }
  /// Number of missed deadlines since creation; real-time safe.
  std::uint64_t deadlines_missed() const noexcept {
    dds_requested_deadline_missed_status_t status{};
    dds_get_requested_deadline_missed_status(entities_.endpoint.get(), &status);
    return status.total_count;
  }
  /// Triggers while samples wait: for WaitSet.
  dds_entity_t condition() const noexcept { return unread_.get(); }
  dds_entity_t get() const noexcept { return entities_.endpoint.get(); }

 private:
  EndpointEntities entities_;
  Entity unread_;
};

}  // namespace voxtouch::bus

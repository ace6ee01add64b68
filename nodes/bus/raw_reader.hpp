#pragma once
/// A reader that returns messages in wire form, for any compiled-in type.
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <type_traits>

#include "nodes/bus/entity.hpp"
#include "nodes/bus/serdata.hpp"

namespace voxtouch::bus {

class RawReader {
 public:
  /// Matches writers of `type` by its name, with or without type information. Throws Error.
  RawReader(dds_entity_t participant, const std::string& topic, const dds_topic_descriptor_t& type,
            const dds_qos_t* qos);

  /// Calls f(std::span<const std::byte>), optionally with the writer's instance handle or the
  /// sample's information, for each waiting message, oldest first.
  /// The bytes are the encapsulation header and the CDR as sent; they are valid until f returns.
  /// DDS converts messages of the other byte order and drops messages that do not match the type.
  /// DDS keeps no time of arrival. Does not block; f must not throw. Returns the number of
  /// messages.
  template <class F>
  std::size_t take(F&& f) {
    constexpr std::uint32_t kBatch = 64;
    std::array<ddsi_serdata*, kBatch> taken{};
    std::array<dds_sample_info_t, kBatch> info{};
    std::size_t count = 0;
    dds_return_t n = kBatch;
    while (n == static_cast<dds_return_t>(kBatch)) {
      n = dds_takecdr(reader_.get(), taken.data(), kBatch, info.data(), DDS_ANY_STATE);
      for (std::size_t i = 0; static_cast<dds_return_t>(i) < n; ++i) {
        const Serdata data(taken[i]);
        if (!info[i].valid_data)
          continue;  // only a writer that appeared or left
        ddsrt_iovec_t bytes{};
        ddsi_serdata* const lent =
            ddsi_serdata_to_ser_ref(data.get(), 0, ddsi_serdata_size(data.get()), &bytes);
        const std::span message(static_cast<const std::byte*>(bytes.iov_base), bytes.iov_len);
        if constexpr (std::is_invocable_v<F, std::span<const std::byte>, dds_instance_handle_t>)
          f(message, info[i].publication_handle);
        else if constexpr (std::is_invocable_v<F, std::span<const std::byte>,
                                               const dds_sample_info_t&>)
          f(message, info[i]);
        else
          f(message);
        ddsi_serdata_to_ser_unref(lent, &bytes);
        ++count;
      }
    }
    return count;
  }
  /// Triggers while messages wait: for WaitSet.
  dds_entity_t condition() const noexcept { return unread_.get(); }
  dds_entity_t get() const noexcept { return reader_.get(); }

 private:
  Entity topic_, reader_, unread_;
};

}  // namespace voxtouch::bus

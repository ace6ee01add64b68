#pragma once
/// Serialises and deserialises a type with Cyclone DDS, without a network. Used for bags.
#include <dds/dds.h>

#include <stdexcept>
#include <string>
#include <string_view>

#include "nodes/bus/serdata.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

template <class T>
class WireForm {
 public:
  /// DDS exposes the serialiser of a type only through a message, so one is written and taken.
  /// Throws std::runtime_error after 1 s without it.
  explicit WireForm(dds_entity_t participant) {
    const std::string name = "wire_form/" + std::string(msg::Type<T>::ros_name);
    const dds_entity_t topic =
        dds_create_topic(participant, msg::Type<T>::descriptor, name.c_str(), nullptr, nullptr);
    const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
    const dds_entity_t writer = dds_create_writer(participant, topic, nullptr, nullptr);
    const T none{};
    ddsi_serdata* taken[1] = {nullptr};
    dds_sample_info_t info;
    for (int tries = 0; !taken[0] && tries < 1000; ++tries, dds_sleepfor(DDS_MSECS(1))) {
      dds_write(writer, &none);
      dds_takecdr(reader, taken, 1, &info, DDS_ANY_STATE);
    }
    sample_.reset(taken[0]);
    dds_delete(writer), dds_delete(reader);
    if (!sample_)
      throw std::runtime_error("DDS does not take a " + name);
  }

  /// Encapsulation header and CDR.
  std::string bytes(const T& message) const {
    const Serdata data(ddsi_serdata_from_sample(sample_->type, SDK_DATA, &message));
    std::string out(ddsi_serdata_size(data.get()), '\0');
    ddsi_serdata_to_ser(data.get(), 0, out.size(), out.data());
    return out;
  }
  /// Decodes `cdr` (header and body) as a reader of T would, and calls f(const T&). Returns false
  /// if DDS rejects it.
  template <class F>
  bool read(std::string_view cdr, F&& f) const {
    if (cdr.size() < 4)
      return false;  // no header: DDS does not check it
    const ddsrt_iovec_t part{const_cast<char*>(cdr.data()), cdr.size()};
    const Serdata data(ddsi_serdata_from_ser_iov(sample_->type, SDK_DATA, 1, &part, cdr.size()));
    if (!data)
      return false;
    T message{};
    const bool whole = ddsi_serdata_to_sample(data.get(), &message, nullptr, nullptr);
    if (whole)
      f(static_cast<const T&>(message));
    dds_sample_free(&message, msg::Type<T>::descriptor, DDS_FREE_CONTENTS);
    return whole;
  }

 private:
  Serdata sample_;
};

}  // namespace voxtouch::bus

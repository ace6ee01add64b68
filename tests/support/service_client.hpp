#pragma once
/// A client of a ring's services, as rmw_cyclonedds creates one: it identifies its replies by its
/// own number and the request's.
#include <dds/dds.h>

#include <chrono>
#include <string>
#include <string_view>
#include <thread>

#include "nodes/bus/entity.hpp"
#include "qos/services.hpp"
#include "voxtouch_msgs/services.hpp"

namespace voxtouch::test {

/// `Service` is one of voxtouch_msgs/services.hpp.
template <class Service>
class ServiceClient {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;

  /// Throws bus::Error, also if the participant's permissions forbid it.
  ServiceClient(dds_entity_t participant, const qos::Service& row, std::string_view rig,
                std::string_view node)
      : requests_(dds_create_topic(participant, Service::request.descriptor,
                                   qos::request_name(row, rig, node).c_str(), nullptr, nullptr),
                  "no topic of requests"),
        replies_(dds_create_topic(participant, Service::response.descriptor,
                                  qos::reply_name(row, rig, node).c_str(), nullptr, nullptr),
                 "no topic of replies") {
    dds_guid_t guid{};
    dds_get_guid(participant, &guid);
    std::string words = "clientid=" + std::string(row.path);
    for (const std::uint8_t byte : guid.v)
      words += std::to_string(byte) + ".";
    words += ';';
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    dds_qset_userdata(qos, words.data(), words.size());
    reader_ = bus::Entity(dds_create_reader(participant, replies_.get(), qos, nullptr),
                          "no reader of replies");
    writer_ = bus::Entity(dds_create_writer(participant, requests_.get(), qos, nullptr),
                          "no writer of requests");
    dds_delete_qos(qos);
    dds_get_instance_handle(writer_.get(), &self_);
  }

  /// Whether a server is known within `patience`.
  bool finds_server(std::chrono::milliseconds patience) const {
    return within(patience, std::chrono::milliseconds(10), [this] {
      return dds_get_matched_subscriptions(writer_.get(), nullptr, 0) > 0 &&
             dds_get_matched_publications(reader_.get(), nullptr, 0) > 0;
    });
  }

  /// Sends a request, and calls f(const Response&) with the reply; false if there is none within
  /// `patience`.
  template <class F>
  bool call(Request request, std::chrono::milliseconds patience, F&& f) {
    request.client_guid = self_;
    request.request_number = ++number_;
    if (dds_write(writer_.get(), &request) != DDS_RETCODE_OK)
      return false;
    return within(patience, std::chrono::microseconds(200), [&] {
      bool is_answered = false;
      void* lent[1] = {nullptr};
      dds_sample_info_t info;
      while (!is_answered && dds_take(reader_.get(), lent, &info, 1, 1) == 1) {
        const auto& response = *static_cast<const Response*>(lent[0]);
        is_answered =
            info.valid_data && response.client_guid == self_ && response.request_number == number_;
        if (is_answered)
          f(response);
        dds_return_loan(reader_.get(), lent, 1);
      }
      return is_answered;
    });
  }

 private:
  template <class Holds>
  static bool within(std::chrono::milliseconds patience, std::chrono::microseconds pause,
                     Holds&& holds) {
    const auto until = std::chrono::steady_clock::now() + patience;
    bool is_so = holds();
    while (!is_so && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(pause);
      is_so = holds();
    }
    return is_so;
  }

  bus::Entity requests_, replies_, reader_, writer_;
  dds_instance_handle_t self_ = 0;
  std::int64_t number_ = 0;
};

}  // namespace voxtouch::test

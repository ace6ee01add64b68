#pragma once
/// A ROS 2 service in the wire form of rmw_cyclonedds. Requests and replies are messages that begin
/// with the numbers of client and request.
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>

#include "nodes/bus/endpoint.hpp"
#include "qos/services.hpp"
#include "voxtouch_msgs/services.hpp"

namespace voxtouch::bus {

/// Identifies a request: its client and its number.
struct Caller {
  std::uint64_t client = 0;  ///< number chosen by the client
  std::int64_t request = 0;
  dds_instance_handle_t writer = 0;  ///< of the client's requests
};

/// The endpoints of one service of any type. Not for the loop: allocates.
class ServiceEndpoints {
 public:
  /// `fits` is the filter for received requests, called in a thread of DDS. A request that does not
  /// fit is never answered. Throws Error.
  ServiceEndpoints(const Participant& participant, const qos::Service& row, std::string_view rig,
                   std::string_view node, const msg::AnyType& request, const msg::AnyType& response,
                   bool (*fits)(const void*));

  /// Calls `send` once the client's reply reader has been discovered, which may be shortly after
  /// the request. A reader that is not discovered within 100 ms gets no reply. Beyond kMaxWaiting
  /// replies the oldest is dropped.
  void reply(const Caller& caller, std::function<void(dds_entity_t writer)> send);
  /// Sends deferred replies; call it often while `waits`.
  void send_waiting();
  bool waits() const noexcept { return !waiting_.empty(); }
  /// Triggers while requests wait: for WaitSet.
  dds_entity_t condition() const noexcept { return unread_.get(); }
  dds_entity_t reader() const noexcept { return requests_.endpoint.get(); }

 private:
  static constexpr std::size_t kMaxWaiting = 64;
  struct Waiting {
    Caller caller;
    dds_time_t until = 0;
    std::function<void(dds_entity_t writer)> send;
  };
  bool knows(const Caller& caller) const;

  EndpointEntities requests_, replies_;
  Entity unread_;
  std::deque<Waiting> waiting_;
};

/// Server of `Service`, one of voxtouch_msgs/services.hpp.
template <class Service>
class ServiceServer {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;

  /// `kFits` checks that texts and lists of a request are within the size limits.
  template <bool (*kFits)(const Request&)>
  static ServiceServer make(const Participant& participant, const qos::Service& row,
                            std::string_view rig, std::string_view node) {
    if (row.type != Service::ros_name)
      throw Error("service " + std::string(row.path) + " is a " + std::string(row.type));
    return ServiceServer(
        {participant, row, rig, node, Service::request, Service::response,
         [](const void* request) { return kFits(*static_cast<const Request*>(request)); }});
  }

  /// Calls f(const Request&, const Caller&) for each waiting request, oldest first, at most `most`.
  /// Does not block.
  template <class F>
  int take(F&& f, int most) {
    int count = 0;
    while (count < most) {
      void* lent[1] = {nullptr};
      dds_sample_info_t info;
      const auto n = dds_take(endpoints_.reader(), lent, &info, 1, 1);
      if (n <= 0)
        return count;
      if (info.valid_data) {
        const auto& request = *static_cast<const Request*>(lent[0]);
        f(request, Caller{request.client_guid, request.request_number, info.publication_handle});
        ++count;
      }
      dds_return_loan(endpoints_.reader(), lent, n);
    }
    return count;
  }
  /// `fill(Response&, send)` fills in the response and calls `send()` while the referenced memory
  /// is valid, immediately or later.
  template <class Fill>
  void reply(const Caller& caller, Fill fill) {
    endpoints_.reply(caller, [caller, fill = std::move(fill)](dds_entity_t writer) {
      Response response{};
      response.client_guid = caller.client;
      response.request_number = caller.request;
      fill(response, [&] { dds_write(writer, &response); });
    });
  }
  /// The participant that sent the request; all zero if it has left.
  Guid participant_of(const Caller& caller) const {
    return participant_of_writer(endpoints_.reader(), caller.writer);
  }
  void send_waiting() { endpoints_.send_waiting(); }
  bool waits() const noexcept { return endpoints_.waits(); }
  dds_entity_t condition() const noexcept { return endpoints_.condition(); }

 private:
  explicit ServiceServer(ServiceEndpoints endpoints) : endpoints_(std::move(endpoints)) {}
  ServiceEndpoints endpoints_;
};

}  // namespace voxtouch::bus

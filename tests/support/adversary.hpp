#pragma once
/// An unauthorised participant that writes any of the ring's messages.
#include <any>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "nodes/bus/writer.hpp"

namespace voxtouch::test {

/// The row of the table for T: each of the ring's types has one.
template <class T>
const qos::Topic& topic_of() {
  for (const qos::Topic& row : qos::kTopics)
    if (row.type == msg::Type<T>::ros_name)
      return row;
  throw bus::Error("no topic carries " + std::string(msg::Type<T>::ros_name));
}

/// One foreign participant in `rig`; a writer a topic, made when it is first used. As `ros2 bag
/// play` or a stray node would write.
class Adversary {
 public:
  Adversary(std::uint32_t domain, std::string rig, qos::TimeMode mode = qos::TimeMode::kRealTime)
      : Adversary({domain, "lo", "adversary"}, std::move(rig), mode) {}
  Adversary(const bus::ParticipantOptions& options, std::string rig,
            qos::TimeMode mode = qos::TimeMode::kRealTime)
      : participant_(options),
        rig_(std::move(rig)),
        mode_(mode) {}

  template <class T>
  bus::Writer<T>& writer() {
    auto& slot = writers_[std::string(msg::Type<T>::ros_name)];
    if (!slot.has_value())
      slot = std::make_shared<bus::Writer<T>>(participant_, topic_of<T>(), rig_,
                                              qos::profile_in(topic_of<T>(), mode_));
    return *std::any_cast<std::shared_ptr<bus::Writer<T>>&>(slot);
  }
  template <class T>
  bool write(const T& message) {
    return writer<T>().write(message);
  }
  /// A status with the given `state` and `session`; `as`: the participant that it claims to be.
  void claim(const std::string& node, std::uint64_t session, std::uint32_t state,
             const bus::Guid& as, const std::string& message = "") {
    std::string name = node, host = "elsewhere", text = message;
    msg::NodeStatus status{};
    status.node = name.data(), status.host = host.data(), status.message = text.data();
    status.pid = 666;
    status.session_id = session, status.state = state;
    std::memcpy(status.participant, as.data(), as.size());
    write(status);
  }
  /// The same with its own participant: valid for DDS.
  void claim(const std::string& node, std::uint64_t session,
             std::uint32_t state = msg::node_status::kStateRunning) {
    claim(node, session, state, participant_.guid());
  }
  const bus::Participant& participant() const noexcept { return participant_; }
  const bus::Guid& guid() const noexcept { return participant_.guid(); }

 private:
  bus::Participant participant_;
  std::string rig_;
  qos::TimeMode mode_;
  std::map<std::string, std::any> writers_;
};

}  // namespace voxtouch::test

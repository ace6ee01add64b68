#include "nodes/cli/up/foreign_writers.hpp"

#include <cstring>

#include "nodes/runtime/rig_roles.hpp"

namespace voxtouch::cli {

ForeignWriters::ForeignWriters(const bus::Participant& participant, const std::string& rig)
    : discovery_(participant.get()),
      recovers_(participant, qos::kRecover, rig, qos::profile(qos::ProfileId::kTap)) {
  for (const qos::Topic& topic :
       {qos::kDeviceState, qos::kContactState, qos::kForceCommand, qos::kDeviceDescription,
        qos::kScenePlan, qos::kCouplingDesign, qos::kValidation, qos::kEffectMade,
        qos::kExternalSample, qos::kRigClaim})
    topics_.emplace(qos::dds_name(topic, rig), topic.path);
}

void ForeignWriters::poll(const runtime::NodeRegistry& registry) {
  const auto writer_of = [this](const bus::Guid& participant) {
    return writers_.contains(participant) || writers_.size() < kMaxRemembered
               ? &writers_[participant]
               : nullptr;
  };
  discovery_.take([&](const dds_builtintopic_endpoint_t& writer) {
    bus::Guid participant{};
    std::memcpy(participant.data(), writer.participant_key.v, participant.size());
    const auto topic = topics_.find(writer.topic_name);
    if (topic == topics_.end())
      return;
    if (UnauthorisedWriter* const one = writer_of(participant))
      one->topics.insert(topic->second);
  });
  recovers_.take_each([&](const msg::Recover&, dds_instance_handle_t writer) {
    if (UnauthorisedWriter* const one =
            writer_of(bus::participant_of_writer(recovers_.get(), writer)))
      ++one->recovers;
  });
  for (auto& [participant, writer] : writers_)
    if (const runtime::NodeReport* const report = registry.report_of(participant);
        report || writer.name.empty())
      writer.name = participant == bus::Guid{} ? "a participant that has left"
                                               : registry.name_of(participant);
}

std::vector<UnauthorisedWriter> ForeignWriters::found(const std::set<bus::Guid>& own) const {
  std::vector<UnauthorisedWriter> all;
  for (const auto& [participant, writer] : writers_)
    if (!own.contains(participant))
      all.push_back(writer);
  return all;
}

}  // namespace voxtouch::cli

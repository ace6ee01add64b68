#pragma once
/// Discovers the writers of the domain.
#include "nodes/bus/entity.hpp"

namespace voxtouch::bus {

class WriterDiscovery {
 public:
  /// Throws Error.
  explicit WriterDiscovery(dds_entity_t participant)
      : reader_(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                "cannot list the writers on the network") {}

  /// Calls f(const dds_builtintopic_endpoint_t&) for each writer that appeared or changed since the
  /// last call, including writers of this process. The argument belongs to DDS. Does not block.
  template <class F>
  void take(F&& f) {
    void* lent[1] = {nullptr};
    dds_sample_info_t info;
    while (dds_take(reader_.get(), lent, &info, 1, 1) == 1) {
      if (info.valid_data && info.instance_state == DDS_ALIVE_INSTANCE_STATE)
        f(*static_cast<const dds_builtintopic_endpoint_t*>(lent[0]));
      dds_return_loan(reader_.get(), lent, 1);
    }
  }

 private:
  Entity reader_;
};

}  // namespace voxtouch::bus

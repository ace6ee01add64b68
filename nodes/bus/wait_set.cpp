#include "nodes/bus/wait_set.hpp"

namespace voxtouch::bus {

WaitSet::WaitSet(const Participant& participant)
    : entity_(dds_create_waitset(participant.get()), "cannot create a wait set") {}

void WaitSet::attach(dds_entity_t condition) {
  const dds_return_t code = dds_waitset_attach(entity_.get(), condition, 0);
  if (code != DDS_RETCODE_OK)
    throw Error(std::string("cannot attach a reader to a wait set (DDS: ") + dds_strretcode(-code) +
                ")");
}

bool WaitSet::wait(dds_duration_t timeout) noexcept {
  dds_attach_t triggered[1];
  return dds_waitset_wait(entity_.get(), triggered, 1, timeout) > 0;
}

}  // namespace voxtouch::bus

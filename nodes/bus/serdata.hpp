#pragma once
/// A message in its wire form, as Cyclone DDS stores it.
#include <memory>

#include <dds/ddsi/ddsi_serdata.h>

namespace voxtouch::bus {

struct SerdataUnref {
  void operator()(ddsi_serdata* data) const noexcept { ddsi_serdata_unref(data); }
};
using Serdata = std::unique_ptr<ddsi_serdata, SerdataUnref>;

}  // namespace voxtouch::bus

#include "devices/lwr/simulated/faults.hpp"

#include <array>

namespace voxtouch::lwr_sim {
namespace {

/// In the order of FaultKind.
constexpr std::array<arm_sim::FaultRow, kFaultKinds> kRows{{
    {"loss", 1.0, 0.0, 1.0, false},
    {"answer_loss", 1.0, 0.0, 1.0, false},
    {"late", 0.003, 0.0, 1.0, false},
    {"jitter", 0.0005, 0.0, 1.0, false},
    {"reorder", 1.0, 0.0, 1.0, false},
    {"duplicate", 1.0, 0.0, 1.0, false},
    {"nan", 1.0, 1.0, 8.0, true},
    {"drives_off", 127.0, 1.0, 127.0, true},
    {"drive_error", 127.0, 1.0, 127.0, true},
    {"estop", 0.0, 0.0, 0.0, false},
    {"quality", 1.0, 0.0, 2.0, true},
    {"silent", 0.0, 0.0, 0.0, false},
}};

}  // namespace

Fault parse_fault(std::string_view text) { return arm_sim::parse_fault_as<FaultKind>(text, kRows); }

}  // namespace voxtouch::lwr_sim

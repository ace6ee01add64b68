#include "devices/fr3/simulated/faults.hpp"

#include <array>

namespace voxtouch::fr3_sim {
namespace {

/// In the order of FaultKind.
constexpr std::array<arm_sim::FaultRow, kFaultKinds> kRows{{
    {"loss", 1.0, 0.0, 1.0, false},
    {"answer_loss", 1.0, 0.0, 1.0, false},
    {"late", 0.003, 0.0, 1.0, false},
    {"jitter", 0.0005, 0.0, 1.0, false},
    {"reorder", 1.0, 0.0, 1.0, false},
    {"duplicate", 1.0, 0.0, 1.0, false},
    {"nan", 1.0, 1.0, 7.0, true},
    {"user_stop", 0.0, 0.0, 0.0, false},
    {"guiding", 0.0, 0.0, 0.0, false},
    {"reflex", 7.0, 0.0, 40.0, true},
    {"not_ready", 0.0, 0.0, 0.0, false},
    {"silent", 0.0, 0.0, 0.0, false},
    {"closed", 0.0, 0.0, 0.0, false},
}};

}  // namespace

Fault parse_fault(std::string_view text) { return arm_sim::parse_fault_as<FaultKind>(text, kRows); }

}  // namespace voxtouch::fr3_sim

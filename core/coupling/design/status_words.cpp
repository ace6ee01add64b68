#include "core/coupling/design/status_words.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace voxtouch::coupling::design {

std::string_view sentence_of(std::string_view status) noexcept {
  using Row = std::pair<std::string_view, std::string_view>;
  static constexpr std::array kRows{
      Row{"as_requested", "all of the requested stiffness holds, with the requested cut-off"},
      Row{"bandwidth_raised",
          "all of the requested stiffness holds, with a higher cut-off than the requested one"},
      Row{"damping_added",
          "all of the requested stiffness holds, with damping injected while in contact"},
      Row{"stiffness_reduced",
          "less stiffness holds than the device could show; `voxtouch design` says why and what "
          "would help"},
      Row{"infeasible",
          "too little stiffness holds for a usable force, so no force is commanded; `voxtouch "
          "design` says what would help"},
      Row{"configured", "the scene sets the coupling by hand, and the designer only judges it"}};
  const auto found = std::ranges::find(kRows, status, &Row::first);
  return found == kRows.end() ? std::string_view() : found->second;
}

}  // namespace voxtouch::coupling::design

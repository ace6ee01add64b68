#include "core/coupling/design/status_words.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace voxtouch::coupling::design {

std::string_view sentence_of(std::string_view status) noexcept {
  using Row = std::pair<std::string_view, std::string_view>;
  static constexpr std::array kRows{
      Row{"as_requested", "the requested stiffness is stable at the requested cut-off"},
      Row{"bandwidth_raised",
          "the requested stiffness is stable at a higher cut-off than requested"},
      Row{"damping_added", "the requested stiffness is stable with injected damping in contact"},
      Row{"stiffness_reduced",
          "less than the requested stiffness is stable; `voxtouch design` lists "
          "reasons"},
      Row{"infeasible",
          "no usable stiffness is stable, so no force is commanded; `voxtouch design` lists "
          "reasons"},
      Row{"configured", "the scene sets the coupling; the designer only checks it"}};
  const auto found = std::ranges::find(kRows, status, &Row::first);
  return found == kRows.end() ? std::string_view() : found->second;
}

}  // namespace voxtouch::coupling::design

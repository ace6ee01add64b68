#pragma once
/// The words of a design's status as sentences, for whoever meets them at an edge of the project.
#include <string_view>

namespace voxtouch::coupling::design {

/// What `as_requested`, `stiffness_reduced`, ... or `configured` means, a sentence without its full
/// stop; empty for another word.
std::string_view sentence_of(std::string_view status) noexcept;

}  // namespace voxtouch::coupling::design

#pragma once
/// The status words of a design as sentences, for user interfaces.
#include <string_view>

namespace voxtouch::coupling::design {

/// Meaning of `as_requested`, `stiffness_reduced`, ... or `configured`, a sentence without its full
/// stop; empty for another word.
std::string_view sentence_of(std::string_view status) noexcept;

}  // namespace voxtouch::coupling::design

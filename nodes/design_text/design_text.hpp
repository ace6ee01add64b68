#pragma once
/// Sentences about coupling designs. They end with a full stop; other texts are parts of sentences.
#include <string>
#include <string_view>
#include <vector>

#include "core/device_fit/fit_coupling.hpp"

namespace voxtouch::design_text {

/// Meaning of `as_requested`, `stiffness_reduced`, ... or `configured`, without full stop; empty
/// for another word.
std::string_view sentence_of(std::string_view status) noexcept;
/// The reason and remedy; empty if there is none.
std::string sentence_of(const device_fit::Refusal& refusal);
/// The design's limits, a sentence each.
std::vector<std::string> reasons_of(const coupling::design::Design& design);

/// "released, 0.2 kg, slowest timing"; empty for an axis without a design.
std::string worst_case_of(const coupling::design::Design& design, std::size_t axis);
/// "Translation: gripped (0.1 kg, 3 Ns/m, 200 N/m), 0.08 kg"; empty without a case.
std::string case_of(const coupling::design::LeastDamping& least);
/// "Translation: ... reaches a damping ratio of 0.2 at most"; empty without a case.
std::string out_of_reach(const coupling::design::LeastDamping& best);
/// "a filter of 100 Hz", "a window of 12 samples".
std::string text_of(const coupling::design::VelocityEstimate& velocity);
/// Slow velocity and bound of the injected damping: predicates of "injected damping".
std::vector<std::string> damping_notes(const coupling::CouplingSpec& spec);

}  // namespace voxtouch::design_text

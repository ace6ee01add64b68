#include "nodes/rendering/frame_counters.hpp"

#include <cmath>

namespace voxtouch::rendering_node {
namespace {

// a smaller sum of cancelling forces is rounding error
constexpr double kForceEpsilonN = 1e-9;

bool touches(const contact::ContactResult& c) noexcept {
  return c.surface_hits + c.interior_hits > 0;
}

}  // namespace

void count(FrameCounters& counters, const rendering::SceneFrame& frame,
           const msg::ContactState& message) noexcept {
  using enum FrameCounter;
  const contact::StageResult& touch = frame.touch;
  const contact::ContactResult& c = touch.contact;
  const auto count_if = [&](FrameCounter counter, bool holds) {
    if (holds)
      counters.note(counter);
  };
  const bool has_force = c.wrench.force.norm() > kForceEpsilonN;
  if (counters[kSamples] == 0.0)
    counters.note(kFirstSample, static_cast<double>(message.sequence_number));
  counters.note(kSamples);
  counters.note(kLongestUs, std::round(static_cast<double>(message.time_spent_ns) * 1e-3));
  count_if(kContact, has_force);
  count_if(kRefused, (message.flags & msg::contact_state::kFlagRefusedSample) != 0);
  count_if(kFast, touch.fast);
  count_if(kTunnellingSuspected, touch.tunnelling_suspected);
  count_if(kPassedThrough, touch.passed_through);
  count_if(kFullyInside, touches(c) && !has_force && c.interior_hits > c.surface_hits);
  count_if(kLatched, touch.latched);
  count_if(kSaturated, c.saturated);
  count_if(kNotConverged, frame.tool.not_converged);
  count_if(kNotInitialised, frame.tool.not_initialised);
  count_if(kAtWorkLimit, frame.tool.at_work_limit);
  counters.note(kResidual, frame.tool.residual_m);
}

Shown shown_of(const rendering::SceneFrame& frame, const msg::ContactState& m,
               const Pose& hand) noexcept {
  return {.stamp_ns = m.sample_time_ns,
          .session = m.session_id,
          .scene_time_s = static_cast<double>(m.scene_time_ns) * 1e-9,
          .hand = hand,
          .object = frame.object,
          .wrench = frame.wrench,
          .contact_force = frame.touch.contact.wrench.force};
}

ShownPoints points_of(const rendering::SceneFrame& frame, rendering::LiveScene& live,
                      bool virtual_tool) noexcept {
  const contact::ContactResult& c = frame.touch.contact;
  ShownPoints shown;
  if (virtual_tool) {
    if (touches(c))
      shown.at[shown.count++] = c.deepest_point;
    return shown;
  }
  rendering::ObjectContacts& objects = live.dominant().contacts();
  const std::size_t every = (c.surface_hits + c.interior_hits) / ShownPoints::kMaxPoints + 1;
  std::size_t n = 0;
  for (std::size_t k = 0; k < objects.size(); ++k)
    for (const contact::Hits* hits : {&objects.object(k).renderer->hits().surface,
                                      &objects.object(k).renderer->hits().interior})
      for (std::size_t i = 0; i < hits->size() && shown.count < ShownPoints::kMaxPoints; ++i)
        if (n++ % every == 0)
          shown.at[shown.count++] = frame.object.position + (*hits)[i].arm;
  return shown;
}

}  // namespace voxtouch::rendering_node

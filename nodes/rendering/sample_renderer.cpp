#include "nodes/rendering/sample_renderer.hpp"

#include <algorithm>

#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/stamps.hpp"

namespace voxtouch::rendering_node {

void SampleRenderer::begin_session(std::optional<std::int64_t> begin_ns) noexcept {
  live_.reset();
  mapping_.reset();
  frame_ = {};  // a contact repeated for a refused sample must not come from another session
  refused_in_a_row_ = 0;
  session_begin_ns_ = begin_ns;
}

void SampleRenderer::take_external(const Wrench& wrench, const msg::DeviceState& next) noexcept {
  if (session_begin_ns_)
    live_.set_external_wrench(
        {wrench, runtime::seconds_between(*session_begin_ns_, next.sample_time_ns)});
}

msg::ContactState SampleRenderer::answer(const msg::DeviceState& state) noexcept {
  const bool fading = live_.fading();
  const bool good =
      !(state.flags & msg::device_state::kFlagPoseLatched) &&
      !mapping_.update(runtime::from_msg(state.pose), runtime::from_msg(state.twist), state.buttons)
           .refused;
  if (good) {
    if (!session_begin_ns_)
      session_begin_ns_ = state.sample_time_ns;
    frame_ = live_.render(mapping_.tool(),
                          runtime::seconds_between(*session_begin_ns_, state.sample_time_ns));
    refused_in_a_row_ = 0;
  } else {
    if (++refused_in_a_row_ > kMaxRepeats)
      frame_ = {}, live_.reset_virtual_tool();
  }
  return message(state, good, fading);
}

msg::ContactState SampleRenderer::message(const msg::DeviceState& state, bool good,
                                          bool fading) noexcept {
  const contact::StageResult& touch = frame_.touch;
  const contact::ContactResult& c = touch.contact;
  msg::ContactState m{};
  m.session_id = state.session_id;
  m.sequence_number = state.sequence_number;
  m.sample_time_ns = state.sample_time_ns;
  m.tool_pose = runtime::to_msg(mapping_.tool().pose);
  m.wrench = runtime::to_msg(frame_.wrench);
  m.contact_wrench = runtime::to_msg(c.wrench);
  m.effects_wrench = runtime::to_msg(frame_.effects.wrench);
  m.object_pose = runtime::to_msg(frame_.object);
  m.spring_n_per_m = live_.spring_n_per_m();
  m.series_m_per_n = live_.series_spring().translation;
  m.series_effects_m_per_n = live_.series_spring().effects;
  m.series_rad_per_nm = live_.series_spring().rotation;
  m.supplied_energy_j = frame_.supplied_energy_j;
  m.scene_time_ns =
      session_begin_ns_ ? runtime::ns_between(*session_begin_ns_, state.sample_time_ns) : 0;
  m.mean_normal = runtime::to_vector(c.mean_normal);
  m.deepest_point = runtime::to_point(c.deepest_point);
  m.deepest_depth_m = c.deepest_depth_m;
  m.residual_m = frame_.tool.residual_m;
  m.queries = frame_.tool.queries;
  m.coherence = c.coherence;
  m.stiffness_bound_n_per_m = frame_.stiffness_bound_n_per_m;
  runtime::to_msg(frame_.stiffness, m.stiffness);
  m.surface_hits = c.surface_hits;
  m.interior_hits = c.interior_hits;
  m.points_tested = c.points_tested;
  m.model = static_cast<std::uint32_t>(live_.dominant().renderer().model());
  m.flags = (c.fallback ? msg::contact_state::kFlagFallback : 0U) |
            (touch.latched ? msg::contact_state::kFlagLatched : 0U) |
            (touch.fast ? msg::contact_state::kFlagFast : 0U) |
            (good ? 0U : msg::contact_state::kFlagRefusedSample) |
            (c.saturated ? msg::contact_state::kFlagSaturated : 0U) |
            (fading ? msg::contact_state::kFlagFading : 0U) |
            (touch.tunnelling_suspected ? msg::contact_state::kFlagTunnellingSuspected : 0U) |
            (mapping_.tool().clutched ? msg::contact_state::kFlagClutched : 0U) |
            (frame_.tool.constrained ? msg::contact_state::kFlagConstrained : 0U) |
            (frame_.tool.not_converged ? msg::contact_state::kFlagNotConverged : 0U) |
            (frame_.tool.not_initialised ? msg::contact_state::kFlagNotInitialised : 0U);
  return m;
}

}  // namespace voxtouch::rendering_node

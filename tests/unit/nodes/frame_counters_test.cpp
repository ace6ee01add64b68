// The rendering's counts of a frame, without DDS.
#include "nodes/rendering/frame_counters.hpp"

#include <gtest/gtest.h>

namespace voxtouch::rendering_node {
namespace {

using enum FrameCounter;

double counted(FrameCounter counter,
               const std::function<void(rendering::SceneFrame&, msg::ContactState&)>& change) {
  rendering::SceneFrame frame;
  msg::ContactState message{};
  change(frame, message);
  FrameCounters counters;
  count(counters, frame, message);
  EXPECT_EQ(counters[kSamples], 1.0);
  return counters[counter];
}

/// Each case triggers one counter; only that one and the samples may change.
TEST(FrameCounters, CountOneKindOfFrameEach) {
  using Frame = rendering::SceneFrame;
  using Change = std::function<void(Frame&, msg::ContactState&)>;
  const std::map<FrameCounter, Change> cases = {
      {kRefused,
       [](Frame&, msg::ContactState& m) { m.flags = msg::contact_state::kFlagRefusedSample; }},
      {kContact, [](Frame& f, msg::ContactState&) { f.touch.contact.wrench.force.z() = 1.0; }},
      {kFast, [](Frame& f, msg::ContactState&) { f.touch.fast = true; }},
      {kTunnellingSuspected,
       [](Frame& f, msg::ContactState&) { f.touch.tunnelling_suspected = true; }},
      {kPassedThrough, [](Frame& f, msg::ContactState&) { f.touch.passed_through = true; }},
      {kFullyInside,
       [](Frame& f, msg::ContactState&) {
         f.touch.contact.interior_hits = 3, f.touch.contact.surface_hits = 2;
       }},
      {kLatched, [](Frame& f, msg::ContactState&) { f.touch.latched = true; }},
      {kSaturated, [](Frame& f, msg::ContactState&) { f.touch.contact.saturated = true; }},
      {kNotConverged, [](Frame& f, msg::ContactState&) { f.tool.not_converged = true; }},
      {kNotInitialised, [](Frame& f, msg::ContactState&) { f.tool.not_initialised = true; }},
      {kAtWorkLimit, [](Frame& f, msg::ContactState&) { f.tool.at_work_limit = true; }}};
  for (const auto& [set, change] : cases)
    for (const auto& [other, unused] : cases)
      EXPECT_EQ(counted(other, change), set == other ? 1.0 : 0.0)
          << static_cast<int>(set) << " " << static_cast<int>(other);
}

TEST(FrameCounters, CountsNoPushingContactAsFullyInside) {
  EXPECT_EQ(counted(kFullyInside,
                    [](auto& f, auto&) {
                      f.touch.contact.interior_hits = f.touch.contact.surface_hits = 2;
                    }),
            0.0);
  EXPECT_EQ(counted(kFullyInside,
                    [](auto& f, auto&) {
                      f.touch.contact.interior_hits = 3, f.touch.contact.wrench.force.x() = 1.0;
                    }),
            0.0);
}

TEST(FrameCounters, KeepTheLargestAndTheFirstSample) {
  FrameCounters counters;
  for (const std::uint64_t n : {4U, 5U, 6U}) {
    rendering::SceneFrame frame;
    frame.tool.residual_m = n == 5 ? 2e-3 : 1e-3;
    msg::ContactState message{};
    message.sequence_number = n;
    message.time_spent_ns = n == 5 ? 7'600 : 1'000;
    count(counters, frame, message);
  }
  EXPECT_EQ(counters[kFirstSample], 4.0);
  EXPECT_EQ(counters[kLongestUs], 8.0);
  EXPECT_EQ(counters[kResidual], 2e-3);
}

}  // namespace
}  // namespace voxtouch::rendering_node

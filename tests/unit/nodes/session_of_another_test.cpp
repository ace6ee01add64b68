// What a rendering takes over from the one that it stands by for, and when it is fit to.
#include "nodes/rendering/session_of_another.hpp"

#include <gtest/gtest.h>

namespace voxtouch::rendering_node {
namespace {

msg::ContactState contact(std::uint64_t sequence, double force_n, double supplied_j = 0.0) {
  msg::ContactState c{};
  c.sequence_number = sequence;
  c.sample_time_ns = 1'000'000 * static_cast<std::int64_t>(sequence) + 5,
  c.scene_time_ns = 1'000'000 * static_cast<std::int64_t>(sequence);
  c.wrench.force.z = force_n;
  c.supplied_energy_j = supplied_j;
  return c;
}

TEST(SessionOfAnother, BeginsAsTheOtherOneHasBegunItOnce) {
  SessionOfAnother session;
  msg::ContactState refused = contact(9, 0.0);
  refused.flags = msg::contact_state::kFlagRefusedSample;
  EXPECT_EQ(session.session_begin(refused), std::nullopt);
  EXPECT_EQ(session.session_begin(contact(10, 0.0)), 5);
  EXPECT_EQ(session.session_begin(contact(11, 0.0)), std::nullopt);
  session.begin();
  EXPECT_FALSE(session.known());
  session.note(contact(1, 0.0), true);
  EXPECT_EQ(session.session_begin(contact(2, 0.0)), std::nullopt) << "its own";
}

TEST(SessionOfAnother, GoesOnWithTheEnergyThatTheOtherOneHasTold) {
  SessionOfAnother session;
  session.note(contact(10, 1.0, 0.25), false);
  session.heed(contact(10, 1.0, 2.0));
  EXPECT_EQ(session.carried_on(contact(14, 1.0, 0.5)).supplied_energy_j, 2.25);
}

TEST(SessionOfAnother, IsFitOnlyWhileBothRenderTheSame) {
  SessionOfAnother session;
  EXPECT_FALSE(session.agrees()) << "nothing has been compared with the other one's";
  std::uint64_t n = 1;
  const auto both = [&](double own_n, double theirs_n) {
    session.note(contact(n, own_n), false), session.heed(contact(n, theirs_n)), ++n;
  };
  both(0.0, 1.0);
  EXPECT_FALSE(session.agrees()) << "a virtual tool without a place";
  both(1.0, 1.05);
  EXPECT_TRUE(session.agrees());
  both(0.0, 1.0);
  EXPECT_TRUE(session.agrees()) << "one sample alone may not have come";
  for (int i = 0; i < 8; ++i)
    both(0.0, 1.0);
  EXPECT_FALSE(session.agrees());
  session.note(contact(n, 0.0), true);
  EXPECT_TRUE(session.agrees()) << "it acts";
}

}  // namespace
}  // namespace voxtouch::rendering_node

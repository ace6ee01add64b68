#include <gtest/gtest.h>

#include <cmath>

#include "devices/lwr/fri_composer.hpp"

namespace voxtouch::lwr::fri {
namespace {

/// A session in command mode, with the measurement that brought it there.
struct Scene {
  Scene() {
    msr.interface.state = State::kMon, msr.interface.quality = Quality::kPerfect;
    msr.robot.power = kAllDrives, msr.robot.control = Control::kJointImpedance;
    session.update(msr, 1e-3, Diagnostic::kNone);
    msr.interface.state = State::kCmd;
    session.update(msr, 1e-3, Diagnostic::kNone);
    push.setConstant(5.0);
  }
  MsrPacket msr = empty_msr();
  FriSession session{SessionRules{}};
  FriComposer composer{ComposerRules{}};
  LwrJoints push;
};

TEST(FriComposer, OmitsTheForceIfTheSessionForbidsIt) {
  Scene s;
  ASSERT_TRUE(s.session.force_allowed());
  EXPECT_EQ(s.composer.answer(s.msr, s.session, true, s.push).command.add_jnt_trq[3], 5.0F);
  s.msr.interface.quality = Quality::kBad;
  s.session.update(s.msr, 1e-3, Diagnostic::kNone);
  ASSERT_TRUE(s.session.in_command());
  EXPECT_EQ(s.composer.answer(s.msr, s.session, true, s.push).command.add_jnt_trq, Joints{});
}

TEST(FriComposer, OmitsANonFiniteOrTooLargeForce) {
  for (const double bad : {std::nan(""), 1e300}) {
    Scene s;
    s.push[6] = bad;
    const CmdPacket& answer = s.composer.answer(s.msr, s.session, true, s.push);
    EXPECT_TRUE(finite(answer));
    EXPECT_EQ(answer.command.add_jnt_trq, Joints{}) << "all of it, not one joint of it";
  }
}

TEST(FriComposer, RepeatsThePositionForAnInvalidPacket) {
  Scene s;
  const CmdPacket before = s.composer.answer(s.msr, s.session, true, s.push);
  const CmdPacket after = s.composer.reply_to_invalid({99, 0, kMsrSize, kMsrId}, s.session);
  EXPECT_EQ(after.command.jnt_pos, before.command.jnt_pos);
  EXPECT_EQ(after.command.add_jnt_trq, Joints{});
  EXPECT_EQ(after.header.refl_seq, 99);
  EXPECT_EQ(after.header.send_seq, before.header.send_seq + 1);
}

}  // namespace
}  // namespace voxtouch::lwr::fri

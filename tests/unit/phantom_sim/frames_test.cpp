// Frames, errors, handles, types and units.
#include <cmath>
#include <limits>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

class Frames : public SimulatedLibrary {};
using Errors = std::vector<phantom::hd::HDerror>;

TEST_F(Frames, HandleOfTheFirstDeviceIsZeroAndCurrent) {
  open();
  EXPECT_EQ(device, 0u);
  EXPECT_EQ(api.hdGetCurrentDevice(), device);
  api.hdDisableDevice(device);
  EXPECT_EQ(api.hdGetCurrentDevice(), phantom::hd::kInvalidHandle);
}

TEST_F(Frames, AcceptsTheUsualNamesOnly) {
  for (const char* name : {"Default PHANToM", "Default Device"}) {
    const phantom::hd::HHD handle = api.hdInitDevice(name);
    EXPECT_NE(handle, phantom::hd::kInvalidHandle) << name;
    api.hdDisableDevice(handle);
  }
  EXPECT_EQ(api.hdInitDevice("Right Hand"), phantom::hd::kInvalidHandle);
  EXPECT_EQ(errors(), Errors{phantom::hd::kCommConfigError});
}

TEST_F(Frames, SecondInitIsRefused) {
  open();
  EXPECT_EQ(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);
  EXPECT_EQ(errors(), Errors{phantom::hd::kDeviceAlreadyInitiated});
  EXPECT_EQ(api.hdGetCurrentDevice(), device);
}

TEST_F(Frames, WrongHandlesAreBad) {
  open();
  api.hdBeginFrame(7);
  api.hdEndFrame(phantom::hd::kInvalidHandle);
  api.hdMakeCurrentDevice(1);
  api.hdDisableDevice(1);
  EXPECT_EQ(errors(), (Errors{phantom::hd::kBadHandle, phantom::hd::kBadHandle,
                              phantom::hd::kBadHandle, phantom::hd::kBadHandle}));
}

TEST_F(Frames, WithoutADeviceNothingCanBeReadOrSwitched) {
  read_vector(phantom::hd::kCurrentPosition);
  api.hdEnable(phantom::hd::kForceOutput);
  EXPECT_EQ(api.hdGetString(phantom::hd::kDeviceModelType), nullptr);
  EXPECT_EQ(errors(), (Errors{phantom::hd::kInvalidOperation, phantom::hd::kInvalidOperation,
                              phantom::hd::kInvalidOperation}));
}

TEST_F(Frames, NewestErrorComesFirst) {
  open();
  api.hdEndFrame(device);
  api.hdGetDoublev(0x9999, Vec3().data());
  api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(1.0, 0.0, 0.0).data());
  EXPECT_EQ(errors(), (Errors{phantom::hd::kFrameError, phantom::hd::kInvalidEnum,
                              phantom::hd::kIllegalEnd}));
  EXPECT_EQ(error(), phantom::hd::kSuccess);
}

TEST_F(Frames, BeginsAndEndsHaveToPair) {
  open_and_start();
  tick([&] {
    api.hdBeginFrame(device);
    api.hdBeginFrame(device);
    api.hdEndFrame(device);
    api.hdEndFrame(device);
  });
  EXPECT_EQ(errors(), (Errors{phantom::hd::kIllegalEnd, phantom::hd::kIllegalBegin}));
}

TEST_F(Frames, OneFrameATick) {
  open_and_start();
  tick([&] {
    frame();
    frame();
  });
  EXPECT_EQ(errors(), (Errors{phantom::hd::kIllegalEnd, phantom::hd::kIllegalBegin}));
  tick([&] { frame(); });
  EXPECT_EQ(errors(), Errors{});
  api.hdDisable(phantom::hd::kOneFrameLimit);
  tick([&] {
    frame();
    frame();
  });
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Frames, LimitOfFramesIsForTicksOnly) {
  open();
  frame();
  frame();
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Frames, SetOutsideAFrameIsAnErrorAndNoForce) {
  open_and_start();
  tick([&] {
    api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(2.0, 0.0, 0.0).data());
    frame();
  });
  EXPECT_EQ(errors(), Errors{phantom::hd::kFrameError});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Frames, TickWithoutASetIsZeroForce) {
  open_and_start();
  tick_force({1.0, 0.0, 0.0});
  EXPECT_NEAR(applied().x(), 1.0, 0.02);
  tick([&] { frame(); });
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Frames, GetOutsideAFrameGivesTheLastFrame) {
  set_motion({0.0, 0.0, 0.0, 0.1, 0.0, 0.0}, 0.5);
  open_and_start();
  Vec3 seen;
  for (int i = 0; i < 200; ++i)
    tick([&] { frame([&] { seen = read_vector(phantom::hd::kCurrentPosition); }); });
  for (int i = 0; i < 20; ++i)
    tick();
  EXPECT_EQ(read_vector(phantom::hd::kCurrentPosition), seen);
  EXPECT_GT((1e3 * tip() - seen).norm(), 0.5);
}

TEST_F(Frames, WrongTypesAreRefusedAndWriteNothing) {
  open();
  phantom::hd::HDint number = 77;
  api.hdGetIntegerv(phantom::hd::kCurrentPosition, &number);
  EXPECT_EQ(number, 77);
  api.hdGetDoublev(phantom::hd::kCurrentButtons, Vec3().data());
  api.hdGetDoublev(phantom::hd::kOutputDof, Vec3().data());
  EXPECT_EQ(errors(), Errors(3, phantom::hd::kInvalidInputType));
}

TEST_F(Frames, NonFiniteNumbersAreRefused) {
  open();
  double x[16] = {};
  for (const phantom::hd::HDenum name : {0x1u, 0x2599u})
    api.hdGetDoublev(name, x);
  api.hdSetDoublev(phantom::hd::kCurrentPosition, x);
  api.hdEnable(phantom::hd::kCurrentPosition);
  EXPECT_FALSE(api.hdIsEnabled(0x4005));
  EXPECT_EQ(api.hdGetString(phantom::hd::kCurrentPosition), nullptr);
  EXPECT_EQ(errors(), Errors(6, phantom::hd::kInvalidEnum));
}

TEST_F(Frames, ValuesOutOfRangeAreRefused) {
  open();
  const double negative = -1.0;
  api.hdSetDoublev(phantom::hd::kSoftwareVelocityLimit, &negative);
  api.hdSetDoublev(phantom::hd::kSoftwareForceImpulseLimit, &negative);
  api.hdSetDoublev(phantom::hd::kSoftwareVelocityLimit, nullptr);
  api.hdGetDoublev(phantom::hd::kCurrentPosition, nullptr);
  api.hdUpdateCalibration(phantom::hd::kCalibrationInkwell);
  EXPECT_EQ(errors(), Errors(5, phantom::hd::kInvalidValue));
}

TEST_F(Frames, NonFiniteForceIsRefusedAndCounted) {
  open_and_start();
  tick_force({std::nan(""), 0.0, 0.0});
  tick_force({0.0, std::numeric_limits<double>::infinity(), 0.0});
  EXPECT_EQ(errors(), Errors(2, phantom::hd::kInvalidValue));
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  EXPECT_EQ(state().non_finite_sets, 2u);
}

TEST_F(Frames, PositionIsInMillimetresAndTheTransformColumnMajor) {
  set_motion({0.03, 0.05, -0.02});
  open();
  // In the reset pose the operator holds the links for the calibration; afterwards the hand moves
  // the tip elsewhere.
  double m[16];
  Vec3 p;
  frame([&] {
    p = read_vector(phantom::hd::kCurrentPosition);
    api.hdGetDoublev(phantom::hd::kCurrentTransform, m);
  });
  EXPECT_LT((p - Vec3(30.0, 50.0, -20.0)).norm(), 0.05);
  EXPECT_EQ(Vec3(m[12], m[13], m[14]), p);
  EXPECT_EQ(m[15], 1.0);
  EXPECT_EQ(m[3], 0.0);
  Mat3 r = Eigen::Map<Eigen::Matrix4d>(m).topLeftCorner<3, 3>();
  EXPECT_LT((r - Mat3::Identity()).norm(),
            0.01);  // the stylus is held level for any motion of the arm
  EXPECT_GT(std::abs(state().joints[0]), 0.05);  // so the gimbal has to make up for the arm
}

TEST_F(Frames, DescribesItself) {
  open();
  EXPECT_STREQ(api.hdGetString(phantom::hd::kDeviceModelType), "PHANTOM Premium 1.5");
  double force = 0.0, stiffness = 0.0, temperature[3] = {9.0, 9.0, 9.0};
  api.hdGetDoublev(phantom::hd::kNominalMaxForce, &force);
  api.hdGetDoublev(phantom::hd::kNominalMaxStiffness, &stiffness);
  api.hdGetDoublev(phantom::hd::kMotorTemperature, temperature);
  EXPECT_DOUBLE_EQ(force, 8.5);
  EXPECT_DOUBLE_EQ(stiffness, 0.8);
  EXPECT_EQ(temperature[2], 0.0);
  int in = 0, out = 0, style = 0;
  api.hdGetIntegerv(phantom::hd::kInputDof, &in);
  api.hdGetIntegerv(phantom::hd::kOutputDof, &out);
  api.hdGetIntegerv(phantom::hd::kCalibrationStyle, &style);
  EXPECT_EQ(in, 6);
  EXPECT_EQ(out, 3);
  EXPECT_EQ(style, 1);
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Frames, SwitchesAreSeenByTheNextFrame) {
  open();
  sim.set_switches(5, 1, 1);
  int buttons = 0;
  api.hdGetIntegerv(phantom::hd::kCurrentButtons, &buttons);
  EXPECT_EQ(buttons, 0);
  frame();
  api.hdGetIntegerv(phantom::hd::kCurrentButtons, &buttons);
  EXPECT_EQ(buttons, 5);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test

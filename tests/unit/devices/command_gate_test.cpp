#include "devices/command_gate.hpp"

#include <gtest/gtest.h>

namespace voxtouch::devices {
namespace {

constexpr std::uint64_t kMine = 77, kNewest = 1000, kAnna = 1, kBert = 2;

TEST(Gate, FollowsTheFirstWriterUntilItGoes) {
  CommandGate gate(kMine);
  EXPECT_EQ(gate.accept(kAnna, kMine, 5, kNewest), GateVerdict::kAccepted);
  EXPECT_EQ(gate.accept(kBert, kMine, 6, kNewest), GateVerdict::kForeignWriter);
  EXPECT_EQ(gate.accept(kAnna, kMine, 6, kNewest), GateVerdict::kAccepted);
  gate.release_writer();
  EXPECT_EQ(gate.accept(kBert, kMine, 6, kNewest), GateVerdict::kOldSequence);
  EXPECT_EQ(gate.accept(kBert, kMine, 7, kNewest), GateVerdict::kAccepted);
  EXPECT_EQ(gate.accept(kAnna, kMine, 8, kNewest), GateVerdict::kForeignWriter);
}

TEST(Gate, RefusesForeignSessions) {
  CommandGate gate(kMine);
  EXPECT_EQ(gate.accept(kAnna, kMine + 1, 5, kNewest), GateVerdict::kForeignSession);
  EXPECT_FALSE(gate.writer());
  EXPECT_EQ(gate.accept(kBert, kMine, 0, kNewest), GateVerdict::kAccepted);
  EXPECT_EQ(gate.writer(), kBert);
}

TEST(Gate, TakesEachAnswerOnceAndInOrder) {
  CommandGate gate(kMine);
  EXPECT_EQ(gate.accept(kAnna, kMine, 0, kNewest), GateVerdict::kAccepted);
  EXPECT_EQ(gate.accept(kAnna, kMine, 0, kNewest), GateVerdict::kOldSequence);
  EXPECT_EQ(gate.accept(kAnna, kMine, 9, kNewest), GateVerdict::kAccepted);
  EXPECT_EQ(gate.accept(kAnna, kMine, 8, kNewest), GateVerdict::kOldSequence);
  EXPECT_EQ(gate.last_sequence(), 9U);
}

TEST(Gate, RefusesAnswersToSamplesThatDoNotExistYet) {
  CommandGate gate(kMine);
  EXPECT_EQ(gate.accept(kAnna, kMine, ~std::uint64_t{0}, kNewest), GateVerdict::kFutureSequence);
  EXPECT_FALSE(gate.writer());
  EXPECT_EQ(gate.accept(kAnna, kMine, kNewest, kNewest), GateVerdict::kAccepted);
}

}  // namespace
}  // namespace voxtouch::devices

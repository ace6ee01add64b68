// Counters that a loop fills, and the sentence that a status shows.
#include "nodes/runtime/counters.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "nodes/runtime/status_text.hpp"

namespace voxtouch::test {
namespace {

using runtime::Counting;
using runtime::StatusPriority;

enum class Shape : std::uint8_t { kSum, kMost, kLast, kHidden, kFirst };
constexpr auto kShapes = std::to_array<runtime::CounterRow<Shape>>(
    {{Shape::kSum, "sum", "samples"},
     {Shape::kMost, "most", "N", Counting::kMaximum},
     {Shape::kLast, "last", "Hz", Counting::kLast},
     {Shape::kHidden, "", "N", Counting::kMaximum},
     {Shape::kFirst, "first", "sample number", Counting::kFirst}});
using Shapes = runtime::Counters<kShapes>;

TEST(Counters, AddRaiseOrSetByTheirTable) {
  Shapes counters;
  for (const double value : {2.0, 5.0, 3.0})
    for (const Shape shape :
         {Shape::kSum, Shape::kMost, Shape::kLast, Shape::kHidden, Shape::kFirst})
      counters.note(shape, value);
  counters.note(Shape::kSum);
  EXPECT_EQ(counters[Shape::kSum], 11.0);
  EXPECT_EQ(counters[Shape::kMost], 5.0);
  EXPECT_EQ(counters[Shape::kLast], 3.0);
  EXPECT_EQ(counters[Shape::kFirst], 2.0);
  EXPECT_EQ(counters.take(Shape::kHidden), 5.0);
  EXPECT_EQ(counters[Shape::kHidden], 0.0) << "it starts again";
}

TEST(Counters, PublishNamesAndUnitsAndFirstValuesIfAny) {
  Shapes counters;
  EXPECT_TRUE(std::isnan(counters[Shape::kFirst]));
  runtime::Figures figures;
  counters.report_to(figures);
  EXPECT_EQ(figures.size(), 3U) << "neither the hidden nor the first";
  EXPECT_EQ(figures.at("most").unit, "N");
  counters.note(Shape::kFirst, 7.0);
  counters.report_to(figures);
  EXPECT_EQ(figures.at("first").value, 7.0);
  runtime::Figures two;
  counters.report_to(two, Shapes::through(Shape::kMost));
  EXPECT_EQ(two.size(), 2U);
}

TEST(StatusText, ShowsTheHighestPriorityAndOfEqualTheFirst) {
  runtime::StatusText status;
  status.set(StatusPriority::kFault, "");
  status.set(StatusPriority::kProgress, "runs");
  status.set(StatusPriority::kFault, "first");
  status.set(StatusPriority::kFault, "second");
  status.set(StatusPriority::kWaiting, "waits");
  status.append("; more");
  EXPECT_EQ(status.text(), "first; more");
}

}  // namespace
}  // namespace voxtouch::test

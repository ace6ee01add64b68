#include "core/types/number.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdint>
#include <limits>
#include <string>

namespace voxtouch {
namespace {

TEST(ParseNumber, ReadsTheWholeText) {
  EXPECT_EQ(parse_number<double>("-2.5e-3"), -2.5e-3);
  EXPECT_EQ(parse_number<double>("inf"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number<std::uint64_t>("18446744073709551615"),
            std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(parse_number<int>("-7"), -7);
}

TEST(ParseNumber, RefusesPartialNumbers) {
  for (const char* text : {"", " 1", "1 ", "+1", "1.5x", "0x10", "1,5", ".", "e3", "1.5", "--1"})
    EXPECT_FALSE(parse_number<std::uint64_t>(text)) << '\'' << text << '\'';
  for (const char* text : {"", " 1", "1 ", "+1", "1.5x", "0x10", "1,5", ".", "e3", "--1"}) {
    const auto value = parse_number<double>(text);
    ASSERT_FALSE(value) << '\'' << text << '\'';
    EXPECT_EQ(value.error(), std::errc::invalid_argument);
  }
  EXPECT_FALSE(parse_number<std::uint64_t>("-1"));
  EXPECT_FALSE(parse_number<int>(std::string_view("1\0002", 3)));
}

TEST(ParseNumber, DistinguishesOutOfRangeFromInvalid) {
  EXPECT_EQ(parse_number<double>("1e999").error(), std::errc::result_out_of_range);
  EXPECT_EQ(parse_number<std::uint16_t>("65536").error(), std::errc::result_out_of_range);
  EXPECT_EQ(parse_number<std::uint16_t>("65536x").error(), std::errc::invalid_argument);
}

TEST(ParseNumber, ReadsAPointAsAPointInEveryLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"})
    std::setlocale(LC_ALL, name);
  EXPECT_EQ(parse_number<double>("0.5"), 0.5);
  EXPECT_FALSE(parse_number<double>("0,5"));
  std::setlocale(LC_ALL, before.c_str());
}

TEST(ParseFinite, TakesNoInfinityAndNoNan) {
  EXPECT_EQ(parse_finite("0.25"), 0.25);
  for (const char* text : {"inf", "-inf", "nan", "1e999", "x"})
    EXPECT_FALSE(parse_finite(text)) << text;
}

}  // namespace
}  // namespace voxtouch

#include "nodes/console/printable.hpp"

#include <gtest/gtest.h>

namespace voxtouch::console {
namespace {

TEST(Printable, LeavesUtf8NewlinesAndTabulatorsAlone) {
  for (const char* text : {"", "plain", "two\nlines\tand more\n", "Größe 3 µm, 力, 😀", "\xC2\xA0"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, RemovesControlCharacters) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a?[2Jb");
  EXPECT_EQ(printable("over\rwritten"), "over?written");
  EXPECT_EQ(printable(std::string_view("\0\a\b\x7f", 4)), "????");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "?31m");  // CSI as one character, U+009B
}

TEST(Printable, RemovesInvalidUtf8) {
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "?31m");                       // CSI as one byte
  EXPECT_EQ(printable("\xC0\x9B"), "??");  // overlong escape
  EXPECT_EQ(printable("\xE0\x80\x9B"), "???");
  EXPECT_EQ(printable("\xED\xA0\x80"), "???");       // surrogate
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "????");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xF0\x9F\x98"), "???");       // cut off
  EXPECT_EQ(printable("a\xE5\x8A"), "a??");
}

}  // namespace
}  // namespace voxtouch::console

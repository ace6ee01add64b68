#include <gtest/gtest.h>

#include "nodes/view/access.hpp"

namespace voxtouch::view {
namespace {

TEST(ViewAccess, AnswersToItsOwnNamesAlone) {
  const Access local{"127.0.0.1", 8765, "t"};
  EXPECT_TRUE(local.admits_host("127.0.0.1:8765"));
  EXPECT_TRUE(local.admits_host("localhost:8765"));
  for (const char* host : {"", "localhost", "127.0.0.1", "127.0.0.1:87650", "example.org:8765",
                           "localhost:8765.example.org"})
    EXPECT_FALSE(local.admits_host(host)) << host;
  const Access network{"192.168.1.5", 8765, "t"};
  EXPECT_TRUE(network.admits_host("192.168.1.5:8765"));
  EXPECT_FALSE(network.admits_host("localhost:8765"));
}

TEST(ViewAccess, NamesTheRemedyForATunnelAtAnotherPort) {
  const Access local{"127.0.0.1", 8765, "t"};
  EXPECT_TRUE(local.remedy_for("localhost:9999").contains("ssh -L 8765:127.0.0.1:8765"));
  EXPECT_EQ(local.remedy_for("example.org:8765"), "");
}

TEST(ViewAccess, AdmitsItsOwnPagesAndNonBrowsers) {
  const Access local{"127.0.0.1", 8765, "t"};
  EXPECT_TRUE(local.admits_origin(""));
  EXPECT_TRUE(local.admits_origin("http://localhost:8765"));
  for (const char* origin : {"null", "http://example.org", "https://localhost:8765",
                             "http://localhost", "localhost:8765"})
    EXPECT_FALSE(local.admits_origin(origin)) << origin;
}

TEST(ViewAccess, RequiresTheWholeToken) {
  const Access access{"127.0.0.1", 1, "0123456789abcdef"};
  EXPECT_TRUE(access.admits_token("0123456789abcdef"));
  for (const char* token : {"", "0", "0123456789abcdee", "0123456789abcdef0"})
    EXPECT_FALSE(access.admits_token(token)) << token;
  EXPECT_FALSE((Access{"127.0.0.1", 1, ""}.admits_token("")));
}

TEST(ViewAccess, MakesAnotherTokenEachTime) {
  EXPECT_EQ(make_token().size(), 32u);
  EXPECT_NE(make_token(), make_token());
}

}  // namespace
}  // namespace voxtouch::view

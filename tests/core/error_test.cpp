#include "core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cradle {
namespace {

TEST(Error, SaysWhereAndWhat) {
  const Error error(ErrorKind::scene, "scenes/a.json:12:7 /bodies/0/mass", "is -1; must be > 0");
  EXPECT_STREQ(error.what(), "scenes/a.json:12:7 /bodies/0/mass: is -1; must be > 0");
  EXPECT_EQ(error.kind(), ErrorKind::scene);
  EXPECT_STREQ(Error(ErrorKind::limit, "", "too many events").what(), "too many events");
}

TEST(Error, KindsAreTheExitCodes) {
  EXPECT_EQ(static_cast<int>(ErrorKind::usage), 2);
  EXPECT_EQ(static_cast<int>(ErrorKind::scene), 3);
  EXPECT_EQ(static_cast<int>(ErrorKind::mesh), 4);
  EXPECT_EQ(static_cast<int>(ErrorKind::output), 5);
  EXPECT_EQ(static_cast<int>(ErrorKind::encoder), 6);
  EXPECT_EQ(static_cast<int>(ErrorKind::unstable), 7);
  EXPECT_EQ(static_cast<int>(ErrorKind::limit), 8);
  EXPECT_EQ(static_cast<int>(ErrorKind::different), 9);
}

TEST(Check, SaysWhatHasFailedAndWhere) {
  const int answer = 42;
  CRADLE_CHECK(answer == 42);
  EXPECT_THAT(
      [&] { CRADLE_CHECK(answer == 43); },
      testing::ThrowsMessage<FailedCheck>(testing::ContainsRegex("check failed: answer == 43 .*error_test.cpp:")));
}

}  // namespace
}  // namespace cradle

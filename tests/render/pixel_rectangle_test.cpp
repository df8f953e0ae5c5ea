#include "render/pixel_rectangle.h"

#include <gmock/gmock.h>

namespace cradle {

bool operator==(const PixelRectangle& a, const PixelRectangle& b) {
  return a.left == b.left && a.bottom == b.bottom && a.right == b.right && a.top == b.top;
}

namespace {

using ::testing::ElementsAre;

const PixelRectangle kEmpty{5, 5, 5, 9};

TEST(PixelRectangle, JoinedHoldsBothAndCommonWhatBothHold) {
  const PixelRectangle a{1, 2, 5, 6}, b{4, 0, 9, 3};
  EXPECT_EQ(joined(a, b), (PixelRectangle{1, 0, 9, 6}));
  EXPECT_EQ(common(a, b), (PixelRectangle{4, 2, 5, 3}));
  EXPECT_EQ(joined(a, kEmpty), a);
  EXPECT_EQ(joined(kEmpty, b), b);
  EXPECT_TRUE(common(a, {7, 0, 9, 9}).isEmpty());
}

// Three in a row share edges, the fourth is a pixel beside the third; the fifth meets the first at a corner.
TEST(PixelRectangle, GroupsApartHaveNothingInCommonNotEvenACorner) {
  const PixelRectangle first{0, 0, 8, 8}, second{8, 0, 16, 8}, third{16, 0, 24, 8}, fourth{25, 0, 30, 8},
      fifth{8, 8, 16, 16};
  EXPECT_THAT(groupsApart({first, second, third, fourth, fifth}),
              ElementsAre(ElementsAre(first, third, fourth), ElementsAre(second), ElementsAre(fifth)));
  EXPECT_TRUE(groupsApart({}).empty());
}

}  // namespace
}  // namespace cradle

#include "simulate/twins.h"

#include <gmock/gmock.h>

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

// Clusters 0 to 3 were of one island; 4 and 5 never.
struct Parted {
  Twins twins{6};
  Parted() { twins.connect({0, 1}), twins.connect({1, 2, 3}), twins.connect({4}), twins.connect({5}); }
};

TEST(Twins, HaveEventsAtOneInstantButForRounding) {
  Parted at;
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3 + 1e-15, 2, 1}, {0.5, 1, 0}, {0.7, 3, 2}}),
              UnorderedElementsAre(Pair(0, 2)));
  EXPECT_EQ(at.twins.together().islandOf(2), at.twins.together().islandOf(0));
  EXPECT_NE(at.twins.together().islandOf(1), at.twins.together().islandOf(0));
}

// Also where one of them has an event to the last bit at the instant of the other's.
TEST(Twins, AreFoundBesideEqualBits) {
  Parted at;
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3 + 1e-15, 0, 0}, {0.3 + 1e-15, 2, 1}}), Not(IsEmpty()));
}

TEST(Twins, AreNoneOfEqualBitsOneIslandOrNoOrigin) {
  Parted at;
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3, 2, 1}}), IsEmpty());
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3 + 1e-15, 2, 0}}), IsEmpty());
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3 + 1e-15, 4, 1}, {0.3 + 2e-15, 5, 2}}), IsEmpty());
  EXPECT_THAT(at.twins.find({{0.3, 0, 0}, {0.3 + 1e-11, 2, 1}}), IsEmpty());
}

}  // namespace
}  // namespace cradle

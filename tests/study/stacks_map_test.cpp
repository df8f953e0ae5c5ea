#include "study/stability/stacks_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

TEST(Stacks, StandByTheContactStepWhateverLiesOnTop) {
  for (const double mass : {1.0, 1000.0})
    EXPECT_EQ(outcomeOf(farthestByContactStep(6, mass)), StackOutcome::stands) << mass;
}

TEST(Stacks, OfEqualBoxesStandByTheFastContactStep) {
  EXPECT_EQ(outcomeOf(farthestByPile(6, 1)), StackOutcome::stands);
}

TEST(Stacks, AreFallenWhenABoxIsFarFromItsPlace) {
  EXPECT_EQ(outcomeOf(0.05), StackOutcome::leans);
  EXPECT_EQ(outcomeOf(0.5), StackOutcome::fallen);
  EXPECT_EQ(outcomeOf(INFINITY), StackOutcome::fallen);
  EXPECT_EQ(outcomeOf(NAN), StackOutcome::stopped);
}

}  // namespace
}  // namespace cradle

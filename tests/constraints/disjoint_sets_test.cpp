#include "constraints/disjoint_sets.h"

#include <gtest/gtest.h>

#include <random>

#include "dynamics/rigid_body.h"

namespace cradle {
namespace {

TEST(DisjointSets, AreNamedByTheFirstBodyThatIsReachedOverJoins) {
  constexpr std::size_t kBodies = 40;
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    DisjointSets sets(kBodies);
    // The oracle has the label of each body, and gives all of one set the smaller of two labels.
    std::vector<int> labels;
    for (std::size_t body = 0; body < kBodies; ++body) labels.push_back(static_cast<int>(body));
    for (int i = 0; i < 45; ++i) {
      const std::size_t a = random() % kBodies, b = random() % kBodies;
      sets.join(static_cast<int>(a), static_cast<int>(b));
      const int least = std::min(labels[a], labels[b]), most = std::max(labels[a], labels[b]);
      std::replace(labels.begin(), labels.end(), most, least);
      for (std::size_t body = 0; body < kBodies; ++body)
        ASSERT_EQ(sets.islandOf(static_cast<int>(body)), labels[body]) << trial << " " << i;
    }
  }
}

// Bodies joined from the last to the first hang on each other in a chain.
TEST(DisjointSets, KeepTheirNamesWhenFlattened) {
  DisjointSets sets(9);
  for (int body = 7; body > 1; --body) sets.join(body - 1, body);
  sets.flatten();
  for (int body = 1; body < 8; ++body) EXPECT_EQ(sets.islandOf(body), 1);
  EXPECT_EQ(sets.islandOf(8), 8);
  sets.join(0, 8), sets.join(7, 8);
  sets.flatten();
  for (int body = 0; body < 9; ++body) EXPECT_EQ(sets.islandOf(body), 0);
}

TEST(DisjointSets, AreNotJoinedByWhatIsFixed) {
  DisjointSets sets(3);
  for (const int body : {2, 0, 1}) sets.join(body, kFixed), sets.join(kFixed, body);
  for (const int body : {0, 1, 2}) EXPECT_EQ(sets.islandOf(body), body);
}

// A chain and a branch close nothing; one more pair between any two that they join closes a loop.
TEST(DisjointSets, OfPairsTellWhetherTheyCloseALoop) {
  const std::set<std::pair<int, int>> tree{{0, 1}, {1, 2}, {1, 3}, {4, 5}};
  EXPECT_FALSE(closeALoop(tree, 6));
  for (int a = 0; a < 6; ++a)
    for (int b = a + 1; b < 6; ++b) {
      std::set<std::pair<int, int>> more = tree;
      const bool isNew = more.insert({a, b}).second, isApart = (a < 4) != (b < 4);
      EXPECT_EQ(closeALoop(more, 6), isNew && !isApart) << a << " " << b;
    }
}

}  // namespace
}  // namespace cradle

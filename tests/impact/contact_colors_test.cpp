#include "impact/contact_colors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace cradle {
namespace {

// 30 bodies at random, a fixed one, and a body that touches 90 others: more than there are colours.
TEST(ContactColors, HaveNoMovingBodyTwiceAndEveryContactOnce) {
  std::mt19937 random(3);
  std::vector<ContactManifold> manifolds;
  const auto add = [&](int a, int b) {
    manifolds.emplace_back();
    manifolds.back().bodyA = a, manifolds.back().bodyB = b;
  };
  for (int i = 0; i < 150; ++i) {
    const int a = static_cast<int>(random() % 30), b = static_cast<int>(random() % 30);
    if (a != b) add(a, b);
    if (i % 5 == 0) add(a, kFixed);
  }
  for (int i = 30; i < 120; ++i) add(120, i);
  std::vector<std::int32_t> active(manifolds.size());
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = static_cast<std::int32_t>(i);

  ContactColoring coloring;
  const ContactColors& colors = coloring.color(manifolds, active, 121);
  for (std::size_t color = 0; color + 1 < colors.starts.size(); ++color) {
    std::set<int> seen;
    for (std::size_t i = colors.starts[color]; i < colors.starts[color + 1]; ++i) {
      const ContactManifold& manifold = manifolds[static_cast<std::size_t>(colors.manifolds[i])];
      EXPECT_TRUE(seen.insert(manifold.bodyA).second);
      if (manifold.bodyB != kFixed) {
        EXPECT_TRUE(seen.insert(manifold.bodyB).second);
      }
    }
  }
  std::vector<std::int32_t> all = colors.manifolds;
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, active);
  EXPECT_LT(colors.starts.size(), 140u);
}

}  // namespace
}  // namespace cradle

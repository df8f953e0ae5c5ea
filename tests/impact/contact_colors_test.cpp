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
  std::vector<ManifoldLink> active;
  const auto add = [&](int a, int b) { active.push_back({static_cast<std::int32_t>(active.size()), a, b, 1}); };
  for (int i = 0; i < 150; ++i) {
    const int a = static_cast<int>(random() % 30), b = static_cast<int>(random() % 30);
    if (a != b) add(a, b);
    if (i % 5 == 0) add(a, kFixed);
  }
  for (int i = 30; i < 120; ++i) add(120, i);

  ContactColoring coloring;
  const ContactColors& colors = coloring.color(active, 121);
  for (std::size_t color = 0; color + 1 < colors.starts.size(); ++color) {
    std::set<int> seen;
    for (std::size_t i = colors.starts[color]; i < colors.starts[color + 1]; ++i) {
      const ManifoldLink& link = colors.links[i];
      EXPECT_TRUE(seen.insert(link.bodyA).second);
      if (link.bodyB != kFixed) {
        EXPECT_TRUE(seen.insert(link.bodyB).second);
      }
    }
  }
  std::set<std::int32_t> all;
  for (const ManifoldLink& link : colors.links) all.insert(link.manifold);
  EXPECT_EQ(all.size(), active.size());
  EXPECT_EQ(colors.links.size(), active.size());
  EXPECT_LT(colors.starts.size(), 140u);
}

}  // namespace
}  // namespace cradle

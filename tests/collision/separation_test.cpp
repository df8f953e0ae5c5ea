#include "collision/separation.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

TEST(SmallestSize, IsThatOfTheSmallerMovingBodyInEitherOrder) {
  const std::vector<double> sizes{0.1, 3, 0.02};
  for (const auto& [a, b, size] : {std::tuple(0, 1, 0.1), {1, 2, 0.02}, {1, kFixed, 3.0}, {kFixed, 2, 0.02}}) {
    Contact contact;
    contact.bodyA = a, contact.bodyB = b;
    EXPECT_EQ(smallestSize(contact, sizes), size);
    std::swap(contact.bodyA, contact.bodyB);
    EXPECT_EQ(smallestSize(contact, sizes), size);
  }
}

}  // namespace
}  // namespace cradle

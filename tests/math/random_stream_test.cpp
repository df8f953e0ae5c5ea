#include "math/random_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace cradle {
namespace {

// Known answers of the authors' library Random123 (kat_vectors, philox4x32 of 10 rounds).
TEST(Philox, GivesTheKnownAnswersOfItsAuthors) {
  using Block = std::array<std::uint32_t, 4>;
  constexpr std::uint32_t kOnes = 0xffffffffU;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
  EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
            (Block{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
  EXPECT_EQ(philox({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U}, {0xa4093822U, 0x299f31d0U}),
            (Block{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U}));
}

TEST(RandomStream, DependsOnSeedIndicesAndNamesAndOnNothingElse) {
  const RandomStream seeded(7);
  RandomStream again = RandomStream(7).at("prior").at(3), stream = seeded.at("prior").at(3);
  EXPECT_EQ(stream.nextBits(), again.nextBits());
  EXPECT_EQ(stream.nextBits(), again.nextBits());
  std::set<std::uint64_t> firsts;
  for (RandomStream other :
       {RandomStream(7), RandomStream(8), seeded.at(0), seeded.at(1), seeded.at(1).at(0), seeded.at(0).at(1),
        seeded.at(""), seeded.at("a"), seeded.at("prior"), seeded.at("a name of more than one block")})
    firsts.insert(other.nextBits());
  EXPECT_EQ(firsts.size(), 10U);
}

// Kolmogorov and Smirnov: n numbers that are uniform have a distance from x below 1.95 / sqrt(n) in all but 0.1 % of
// cases, and the seed is fixed.
TEST(RandomStream, NumbersOfOneStreamAndFirstNumbersOfManyAreUniform) {
  constexpr int kCount = 10'000;
  std::vector<double> inOne, ofMany;
  RandomStream one = RandomStream(1).at("one");
  for (std::uint64_t i = 0; i < kCount; ++i) {
    inOne.push_back(one.nextUniform());
    ofMany.push_back(RandomStream(1).at(i).nextUniform());
  }
  for (std::vector<double>* numbers : {&inOne, &ofMany}) {
    std::sort(numbers->begin(), numbers->end());
    double distance = 0;
    for (std::size_t i = 0; i < numbers->size(); ++i)
      distance = std::max(distance, std::abs((*numbers)[i] - (static_cast<double>(i) + 0.5) / kCount));
    EXPECT_LT(distance, 1.95 / std::sqrt(kCount));
    EXPECT_GT(numbers->front(), 0);
    EXPECT_LT(numbers->back(), 1);
  }
}

// The distribution function is erfc(-x / sqrt(2)) / 2, whose relative slope is |x| at most where it is small: an error
// of 1e-15 of x, and of 1e-15 of erfc, makes (x^2 + 1) 1e-15.
TEST(NormalQuantile, IsTheInverseOfTheDistributionFunctionInTheMiddleAndInBothTails) {
  for (const double probability :
       {1e-16, 1.3e-11, 1.4e-11, 1e-6, 0.01, 0.0749, 0.0751, 0.3, 0.5, 0.7, 0.9249, 0.9251}) {
    const double x = normalQuantile(probability);
    EXPECT_NEAR(std::erfc(-x / std::sqrt(2.0)) / 2 / probability, 1, 3e-15 * (x * x + 1)) << probability;
  }
  EXPECT_DOUBLE_EQ(normalQuantile(0.975), 1.959963984540054);
  EXPECT_EQ(normalQuantile(0.25), -normalQuantile(0.75));
}

}  // namespace
}  // namespace cradle

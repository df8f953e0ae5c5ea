#include "simulate/corrections.h"

#include <gmock/gmock.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

TEST(Corrections, AreCountedByKindAndToldOnceOfEach) {
  Corrections corrections;
  corrections.record({CorrectionKind::clampedEnergy, 0.5, {0}, 1e-3});
  corrections.record({CorrectionKind::clampedEnergy, 0.7, {1}, 2e-3});
  corrections.record({CorrectionKind::unsolvedContacts, 0.8, {1}, 1e-2});
  const std::vector<Correction> first = corrections.takeFirst();
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].time, 0.5);
  EXPECT_EQ(first[1].kind, CorrectionKind::unsolvedContacts);
  corrections.record({CorrectionKind::clampedEnergy, 0.9, {1}, 2e-3});
  EXPECT_TRUE(corrections.takeFirst().empty());
  std::map<std::string, long> counts;
  corrections.addCounts(counts), corrections.addCounts(counts);
  EXPECT_EQ(counts, (std::map<std::string, long>{{"clampedEnergy", 6}, {"unsolvedContacts", 2}}));
}

TEST(Corrections, AreDescribedWithTimeAndBodies) {
  const Scene scene = sceneWith(
      fmt::format(R"("duration": 1, "bodies": [{}, {}])", ball("first", Vec3::Zero()), ball("second", Vec3::UnitX())));
  for (std::size_t kind = 0; kind < kCorrectionKinds; ++kind) {
    const std::string text = describe({static_cast<CorrectionKind>(kind), 0.25, {0, 1}, 7}, scene);
    EXPECT_THAT(text, HasSubstr("at 0.25 s "));
    EXPECT_THAT(text, HasSubstr("\"first\", \"second\""));
    EXPECT_THAT(text, HasSubstr("7"));
    EXPECT_FALSE(correctionName(static_cast<CorrectionKind>(kind)).empty());
  }
}

}  // namespace
}  // namespace cradle

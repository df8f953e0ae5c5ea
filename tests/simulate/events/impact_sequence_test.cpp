#include "simulate/events/impact_sequence.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "dynamics/rigid_body.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Balls on the x axis, each with the next in reach: contact i is between ball i and ball i + 1. A mass may be
/// infinite.
class Row {
 public:
  Row(std::vector<double> masses, const std::vector<double>& velocities, const std::vector<double>& gaps)
      : masses_(std::move(masses)), state_(VectorX::Zero(stateSize(std::ssize(masses_)))), radii_(masses_.size(), 0.1) {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      setOrientation(state_, static_cast<Eigen::Index>(i), Quat::Identity());
      velocity(i) = velocities[i];
    }
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      Contact contact;
      contact.pair = i, contact.bodyA = static_cast<int>(i), contact.bodyB = static_cast<int>(i + 1);
      contact.normal = Vec3::UnitX(), contact.separation = gaps[i];
      contacts_.push_back(contact);
    }
    limits_.gapErrors.assign(gaps.size(), 1e-14);
    limits_.gapRounding = 4e-13, limits_.touchTolerance = 1e-12;
    limits_.reach = 1e-2, limits_.duration = kInfinite;
  }

  double& velocity(std::size_t ball) { return state_[velocityOffset(state_, static_cast<Eigen::Index>(ball))]; }
  double position(std::size_t ball) { return centerOfMass(state_, static_cast<Eigen::Index>(ball)).x(); }
  VectorX& state() { return state_; }
  SequenceLimits& limits() { return limits_; }
  std::vector<Contact>& contacts() { return contacts_; }
  ImpactSequence sequence(const std::optional<std::size_t>& meeting = std::nullopt) {
    return ImpactSequence(contacts_, meeting, radii_, limits_, state_);
  }

  /// The impact of two neighbours by Newton's restitution.
  void strike(std::size_t contact, double restitution) {
    const double massA = masses_[contact], massB = masses_[contact + 1];
    const double opening = velocity(contact + 1) - velocity(contact);
    const double impulse = -(1 + restitution) * opening / (1 / massA + 1 / massB);
    velocity(contact) -= impulse / massA, velocity(contact + 1) += impulse / massB;
  }

 private:
  std::vector<double> masses_;
  VectorX state_;
  std::vector<double> radii_;
  std::vector<Contact> contacts_;
  SequenceLimits limits_;
};

// The oracle moves the balls themselves, in long double, from collision to collision.
TEST(ImpactSequence, HasTheImpactsOfARowInTheirOrder) {
  const std::vector<double> masses = {2, 1, 3, 0.5, 1.5}, gaps = {0, 3e-9, 1e-9, 5e-9};
  const std::vector<double> starts = {4, 0, 0.5, -1, 0};
  const double restitution = 0.7;
  Row row(masses, starts, gaps);
  ImpactSequence sequence = row.sequence();
  EXPECT_TRUE(sequence.beginsNow());
  std::vector<std::size_t> order;
  while (sequence.next(row.state())) {
    ASSERT_EQ(sequence.members().size(), 1u);
    order.push_back(sequence.members()[0]);
    row.strike(order.back(), restitution);
    sequence.finishImpact(row.state());
  }
  const std::vector<double> ends = {row.velocity(0), row.velocity(1), row.velocity(2), row.velocity(3),
                                    row.velocity(4)};
  ASSERT_TRUE(sequence.moveBodies(row.state()));

  std::vector<long double> places = {0, 0, 0, 0, 0}, speeds(starts.begin(), starts.end()),
                           open(gaps.begin(), gaps.end());
  std::vector<std::size_t> expected;
  for (;;) {
    long double soonest = kInfinite;
    std::size_t next = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const long double closing = speeds[i] - speeds[i + 1];
      const long double time = open[i] / closing;
      if (closing > 0 && time < soonest) soonest = time, next = i;
    }
    if (soonest == kInfinite) break;
    for (std::size_t i = 0; i < 5; ++i) places[i] += soonest * speeds[i];
    for (std::size_t i = 0; i < 4; ++i) open[i] += soonest * (speeds[i + 1] - speeds[i]);
    open[next] = 0;
    const long double impulse =
        (1 + restitution) * (speeds[next] - speeds[next + 1]) / (1 / masses[next] + 1 / masses[next + 1]);
    speeds[next] -= impulse / masses[next], speeds[next + 1] += impulse / masses[next + 1];
    expected.push_back(next);
  }
  ASSERT_GT(expected.size(), 6u);
  EXPECT_EQ(order, expected);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(ends[i], static_cast<double>(speeds[i]), 1e-14) << i;  // rounding of ten impacts of 4 m/s
    // Of ways of some 1e-8 m, to ten roundings.
    EXPECT_NEAR(row.position(i), static_cast<double>(places[i]), 1e-22) << i;
  }
}

// The first ball has no way to go. The second gap closes after 1e-9 m / 1 m/s, in which ball 1 goes by 1e-9 m.
TEST(ImpactSequence, EndsWhereABodyWouldMoveByHalfOfTheReach) {
  for (const double reach : {1.9e-9, 2.1e-9}) {
    Row row({1, 1, 1}, {1, 0, 0}, {0, 1e-9});
    row.limits().reach = reach;
    ImpactSequence sequence = row.sequence();
    ASSERT_TRUE(sequence.next(row.state()));
    row.strike(0, 1);
    sequence.finishImpact(row.state());
    EXPECT_EQ(sequence.next(row.state()), reach > 2e-9);
  }
}

// A body that spins goes as far as its surface does: 0.1 m at 30 rad/s are 3 m/s, three times the ball's 1 m/s.
TEST(ImpactSequence, CountsTurningAsAWayThatBodiesGo) {
  for (const double reach : {5.9e-9, 6.1e-9}) {
    Row row({1, 1}, {1, 0}, {1e-9});
    row.limits().reach = reach;
    angularVelocity(row.state(), 1) = Vec3(0, 0, 30);
    ImpactSequence sequence = row.sequence();
    EXPECT_FALSE(sequence.beginsNow());
    EXPECT_EQ(sequence.next(row.state()), reach > 6e-9);
  }
}

TEST(ImpactSequence, EndsWhereForcesWouldCount) {
  for (const double duration : {0.9e-9, 1.1e-9}) {
    Row row({1, 1}, {2, 1}, {1e-9});
    row.limits().duration = duration;
    EXPECT_EQ(row.sequence().next(row.state()), duration > 1e-9);
  }
}

// A gap that is no larger than its rounding closes before the sequence ends: an event would not find it.
TEST(ImpactSequence, ClosesGapsAtItsEndThatEventsCouldNotSee) {
  for (const double gap : {7.9e-13, 8.1e-13}) {  // twice the rounding of 4e-13 m: both measured ends are
    Row row({1, 1}, {2, 1}, {gap});
    row.limits().duration = 0;
    EXPECT_EQ(row.sequence().next(row.state()), gap < 8e-13);
  }
}

// A gap of 2e-12 m that closes at 2 m/s is none at the instant of the event, 1e-12 s from here: the other gap then is
// 5e-12 m - 1e-12 s x 1 m/s. Its impact comes 4e-12 s later, in which ball 3 goes by 12e-12 m.
TEST(ImpactSequence, TakesAllGapsAtTheInstantOfTheMeeting) {
  Row row({1, 1, 1, 1}, {2, 0, 4, 3}, {2e-12, 1, 5e-12});
  row.limits().touchTolerance = 1e-11;
  ImpactSequence sequence = row.sequence(0);
  ASSERT_TRUE(sequence.beginsNow());
  ASSERT_TRUE(sequence.next(row.state()));
  EXPECT_THAT(sequence.members(), ElementsAre(0u));
  row.strike(0, 1);
  sequence.finishImpact(row.state());
  ASSERT_TRUE(sequence.next(row.state()));
  EXPECT_THAT(sequence.members(), ElementsAre(2u));
  row.strike(2, 1);
  sequence.finishImpact(row.state());
  EXPECT_FALSE(sequence.next(row.state()));
  ASSERT_TRUE(sequence.moveBodies(row.state()));
  EXPECT_NEAR(row.position(3), 12e-12, 1e-26);
}

// What is closed by 1e-12 m at the instant of the event was so before: time does not go back to where it was not, 5e-11
// s ago, when contact 2 had a gap of 1e-10 m.
TEST(ImpactSequence, DoesNotGoBackToWhereAContactWasNotClosed) {
  Row row({1, 1, 1, 1}, {0.02, 0, 2, 0}, {-1e-12, 1, 5e-15});
  row.limits().duration = 0;
  ImpactSequence sequence = row.sequence(0);
  ASSERT_TRUE(sequence.next(row.state()));
  EXPECT_THAT(sequence.members(), UnorderedElementsAre(0u, 2u));
}

// Without the event the same gap is one.
TEST(ImpactSequence, MeasuresGapsWhereNothingMeets) {
  Row row({1, 1}, {2, 0}, {2e-12});
  EXPECT_FALSE(row.sequence().beginsNow());
  EXPECT_TRUE(row.sequence(0).beginsNow());
}

TEST(ImpactSequence, HasContactsWithoutAGapThatDoNotOpenAsMembers) {
  // Contact 0 closes, 1 stays together, 2 opens: its balls have let go of each other.
  Row row({1, 1, 1, 1}, {1, 0, 0, 1e-3}, {0, 0, 0});
  ImpactSequence sequence = row.sequence();
  ASSERT_TRUE(sequence.next(row.state()));
  EXPECT_THAT(sequence.members(), UnorderedElementsAre(0u, 1u));
}

// A contact that opens more slowly than one that counts as closed has no gap when another contact closes: a row would
// hold it then. One that opens faster is apart, however near.
TEST(ImpactSequence, KeepsContactsClosedThatHardlyOpen) {
  for (const double openingSpeed : {1e-8, 1e-9}) {
    Row row({1, 1, 1}, {1e-8, 0, -1}, {0, 5e-9});
    row.limits().openingSpeed = openingSpeed;
    ImpactSequence sequence = row.sequence();
    ASSERT_TRUE(sequence.next(row.state()));
    EXPECT_THAT(sequence.members(), ElementsAre(0));
    row.strike(0, 0.5);  // it opens at 5e-9 m/s
    sequence.finishImpact(row.state());
    ASSERT_TRUE(sequence.next(row.state()));
    if (openingSpeed > 5e-9)
      EXPECT_THAT(sequence.members(), ElementsAre(0, 1));
    else
      EXPECT_THAT(sequence.members(), ElementsAre(1));
  }
}

// Corners of one face land at once, to what rounding tells; those of another pair have instants of their own.
TEST(ImpactSequence, TakesPointsOfOnePairTogether) {
  for (const bool isOnePair : {true, false}) {
    Row row({1, 1, 1}, {2, 0, -2}, {0, 6e-13});
    if (isOnePair) row.contacts()[1].pair = 0;
    ImpactSequence sequence = row.sequence();
    ASSERT_TRUE(sequence.next(row.state()));
    EXPECT_EQ(sequence.members().size(), isOnePair ? 2u : 1u);
  }
}

// What wedges closes still after its impact, and would come again and again.
TEST(ImpactSequence, DoesNotRepeatAClosingThatAnImpactCouldNotEnd) {
  Row row({1, 1}, {1, 0}, {0});
  ImpactSequence sequence = row.sequence();
  ASSERT_TRUE(sequence.next(row.state()));
  row.velocity(0) = 0.25;  // it still closes
  sequence.finishImpact(row.state());
  EXPECT_FALSE(sequence.next(row.state()));
  row.velocity(0) = 0.5;  // driven by others
  EXPECT_TRUE(sequence.next(row.state()));
}

TEST(ImpactSequence, HasNoImpactsSlowerThanWhatIsStill) {
  for (const double speed : {0.9e-9, 1.1e-9}) {
    Row row({1, 1}, {speed, 0}, {0});
    row.limits().stillSpeed = 1e-9;
    EXPECT_EQ(row.sequence().next(row.state()), speed > 1e-9);
  }
}

// A light ball (m = 1) between a fixed wall and a heavy one (M). A round of impacts maps the speeds linearly, and with
// e = 0.1 its eigenvalues are real, so that impacts have no end, for M / (1 + M) >= 4 e / (1 + e)^2 = 0.3306: M >=
// 0.494.
TEST(ImpactSequence, CollapsesWhereARoundOfImpactsHasRealEigenvalues) {
  for (const double mass : {0.3, 0.45, 0.55, 10.0}) {
    const double restitution = 0.1;
    Row row({kInfinite, 1, mass}, {0, 0, -1}, {1e-6, 0});
    ImpactSequence sequence = row.sequence();
    int impacts = 0;
    bool collapses = false;
    while (!collapses && impacts < 5000 && sequence.next(row.state())) {
      ++impacts;
      collapses = sequence.isCollapse();
      if (collapses) break;
      for (const std::size_t contact : sequence.members()) row.strike(contact, restitution);
      sequence.finishImpact(row.state());
    }
    EXPECT_EQ(collapses, mass > 0.494) << mass;
    if (!collapses) {
      EXPECT_LT(impacts, 50) << mass;
      EXPECT_GE(row.velocity(1), 0);
      EXPECT_GE(row.velocity(2), row.velocity(1));  // nothing closes any more
      continue;
    }
    // All of them take part in the impact that is left, which ends the sequence.
    EXPECT_THAT(sequence.members(), UnorderedElementsAre(0u, 1u));
    row.velocity(1) = row.velocity(2) = 0;
    sequence.finishImpact(row.state());
    EXPECT_FALSE(sequence.next(row.state())) << mass;
  }
}

// A ball of 1 kg between a wall and one of 100^n kg without loss: as many impacts as the first digits of pi (G.
// Galperin, "Playing pool with pi", 2003). They crowd, and have an end all the same.
TEST(ImpactSequence, HasAsManyImpactsAsPiAndDoesNotTakeThemForACollapse) {
  for (const auto& [mass, digits] : {std::pair(1e4, 314), std::pair(1e6, 3141)}) {
    Row row({kInfinite, 1, mass}, {0, 0, -1}, {1e-5, 1e-5});
    ImpactSequence sequence = row.sequence();
    int impacts = 0;
    while (impacts < 4000 && sequence.next(row.state())) {
      ++impacts;
      ASSERT_FALSE(sequence.isCollapse()) << impacts;
      for (const std::size_t contact : sequence.members()) row.strike(contact, 1);
      sequence.finishImpact(row.state());
    }
    EXPECT_EQ(impacts, digits);
  }
}

TEST(ImpactSequence, MovesTurningBodiesByTheTimeElapsed) {
  Row row({1, 1}, {2, 1}, {1e-3});
  row.limits().reach = 1;
  angularVelocity(row.state(), 1) = Vec3(0, 40, 30);
  ImpactSequence sequence = row.sequence();
  ASSERT_TRUE(sequence.next(row.state()));  // after 1e-3 s
  EXPECT_EQ(row.position(0), 0);
  ASSERT_TRUE(sequence.moveBodies(row.state()));
  EXPECT_NEAR(row.position(0), 2e-3, 1e-18);
  // 0.05 rad about (0, 0.8, 0.6)
  const Quat turned = orientation(row.state(), 1);
  EXPECT_NEAR(turned.w(), std::cos(0.025), 1e-15);
  EXPECT_LT((turned.vec() - std::sin(0.025) * Vec3(0, 0.8, 0.6)).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle

#include "collision/core_separation.h"

#include <gtest/gtest.h>

#include "collision/convex_tolerances.h"
#include "collision/sample_cores.h"
#include "collision/widest_gap.h"
#include "rounding.h"

namespace cradle {
namespace {

// Of the size: a gap is a difference of two support values, each some 16 rounded products and sums.
constexpr double kSeparationRounding = 64 * kEpsilon;

// What it says is what its normal sees, and no direction of a search sees more. (Of ways out of cores with rims that
// differ by 1/1000 either may be taken.)
TEST(CoreSeparation, IsTheLargestGapThatANormalSeesAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    int apart = 0, overlapping = 0;
    forRandomCorePairs(size, 0.5, 2, [&](const CorePair& pair) {
      if (pair.sampleA.collider.isSphere() || pair.sampleB.collider.isSphere()) return;  // not of points
      const SeparatingAxis found = separationOf(pair.a, pair.b);
      EXPECT_NEAR(found.normal.norm(), 1, 4 * kEpsilon);
      // Between cores without rims the distance is that of nearest points, whose normal sees as much to gapRounding.
      EXPECT_NEAR(pair.gapSeen(found.normal), found.separation, 2e-14 * size) << pair.name();
      const auto gapSeen = [&](const Vec3& direction) { return pair.gapSeen(direction); };
      const double widest = gapSeen(widestGap(gapSeen, {300, 4, 1e-5}));
      widest > 0 ? ++apart : ++overlapping;
      const double either = pair.isRound() && widest < 0 ? -1e-3 * widest : 0;
      EXPECT_GE(found.separation, widest - either - 2e-14 * size) << pair.name();
    });
    EXPECT_GT(apart, 15);
    EXPECT_GT(overlapping, 15);
  }
}

// Faces, crossing edges and a rim that come together and go through each other: the separation is their shift.
TEST(CoreSeparation, PassesThroughTouchingByTheShift) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4)), bar = boxCore("bar", Vec3(1, 1, 6)),
                   drum = cylinderCore("drum", 0.5, 0.8), segment = segmentCore(2);
  const Quat straight = Quat::Identity(), onEdge = rotationAbout(Vec3::UnitZ(), M_PI / 4);
  const Quat across = rotationAbout(Vec3::UnitY(), M_PI / 2) * onEdge;
  for (const double shift : {0.01, 1e-6, 1e-11, 1e-15, 0.0, -1e-15, -1e-11, -1e-6, -0.01}) {
    const auto expectShift = [&](const CorePair& pair, const Vec3& normal, double known) {
      for (const bool isTurnedRound : {false, true}) {
        const SeparatingAxis found = isTurnedRound ? separationOf(pair.b, pair.a) : separationOf(pair.a, pair.b);
        EXPECT_NEAR(found.separation, shift, known) << pair.name() << shift;
        EXPECT_NEAR(found.normal.dot(isTurnedRound ? Vec3(-normal) : normal), 1, 1e-9) << pair.name() << shift;
      }
    };
    const Vec3 up(0, shift, 0);
    expectShift({box, box, {}, {straight, Vec3(0.3, 0.6, 0.1) + up}}, Vec3::UnitY(), kSeparationRounding);
    expectShift({bar, bar, {onEdge, Vec3::Zero()}, {across, Vec3(0.1, std::sqrt(2), 0.2) + up}}, Vec3::UnitY(),
                4 * kSeparationRounding);
    expectShift({box, segment, {}, {straight, Vec3(0.1, 1.3, 0.2) + up}}, Vec3::UnitY(), kSeparationRounding);
    expectShift({box, drum, {}, {straight, Vec3(0.1, 0.7, 0.2) + up}}, Vec3::UnitY(), 2e-12);
    expectShift({drum, drum, {}, {straight, Vec3(0.6, 0.3, 0.8) + Vec3(0.6 * shift, 0, 0.8 * shift)}},
                Vec3(0.6, 0, 0.8), 2e-12);
  }
}

// The faces of two drums, tilted against each other about the line of their middles by a small t, face each other over
// a lens. The gap c over it falls towards one of its corners, where the rims cross, h from that line: to c - t h, but
// for t^2. No face sees it, GJK stalls between the faces, and a climb from there ends up to some t h lower.
TEST(CoreSeparation, OfNearlyParallelFacesIsThatWhereTheirRimsCross) {
  const SampleCore drum = cylinderCore("drum", 0.5, 0.8);
  for (const double tilt : {1e-9, 1e-8, 1e-7, 1e-6})
    for (const double parts : {3.0, 30.0, 300.0, 1000.0, 2000.0, 5000.0, 10000.0, 20000.0})
      for (const double apart : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85})
        for (const double side : {1.0, -1.0}) {
          const double height = std::sqrt(0.25 - apart * apart / 4), gap = parts * tilt * height;
          const Quat turn = rotationAbout(Vec3(0.6, 0, 0.8), side * tilt);
          const CorePair pair{drum, drum, {}, {turn, Vec3(0.6 * apart, 0.8 + gap, 0.8 * apart)}};
          const double known = kSeparationRounding + tilt * tilt + 1e-8 * gap;  // kRoundDistance
          EXPECT_NEAR(separationOf(pair.a, pair.b).separation, gap - tilt * height, known) << tilt << ' ' << parts;
        }
}

// Two segments have no depth: where they cross or lie in each other their gap is 0, across both.
TEST(CoreSeparation, OfSegmentsThatMeetIsZeroAcrossBoth) {
  const SampleCore segment = segmentCore(2);
  for (const double angle : {0.0, 1e-12, 0.3, M_PI / 2}) {
    const CorePair pair{segment, segment, {}, {rotationAbout(Vec3::UnitZ(), angle), Vec3::Zero()}};
    for (const SeparatingAxis& found : {separationOf(pair.a, pair.b), contactAxis(pair.a, pair.b)}) {
      EXPECT_NEAR(found.separation, 0, kSeparationRounding) << angle;
      EXPECT_NEAR(found.normal.norm(), 1, 4 * kEpsilon);
      EXPECT_NEAR(found.normal.dot(pair.a.axis()), 0, 4 * kEpsilon);
      EXPECT_NEAR(found.normal.dot(pair.b.axis()), 0, 4 * kEpsilon + (angle < 1e-11 ? angle : 0));
    }
  }
}

// A box that stands on a face and is tilted: below 1e-7 of the size it is held by that face, above by a corner or edge
// alone, which has a normal of its own. Both faces see the same gap: the normal is their mean.
TEST(ContactAxis, IsThatOfAFaceWhereItSeesAsMuchButForRounding) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4)), drum = cylinderCore("drum", 0.5, 0.8);
  const ConvexTolerances tolerances(Core(box.collider, {}), Core(box.collider, {}));
  const Vec3 up = Vec3::UnitY();
  const auto expectFace = [&](const CorePair& pair, const Vec3& ofB) {
    const SeparatingAxis found = contactAxis(pair.a, pair.b);
    const double fromFaces = std::min((found.normal - up).norm(), (found.normal - ofB).norm());
    EXPECT_LT(std::min(fromFaces, (found.normal - (up + ofB).normalized()).norm()), 8 * kEpsilon) << pair.name();
    const double seen = std::max(pair.gapSeen(up), pair.gapSeen(ofB));
    EXPECT_NEAR(found.separation, seen, tolerances.equalGaps) << pair.name();
    EXPECT_NEAR(pair.gapSeen(found.normal), found.separation, kSeparationRounding) << pair.name();
    EXPECT_NEAR(found.separation, separationOf(pair.a, pair.b).separation, tolerances.facePreference) << pair.name();
  };
  // In the middle of each other, and over an edge and over a corner: there the edges that cross see a little more.
  for (const Vec3& place : {Vec3(0.2, 0, 0.1), Vec3(0.7, 0, 0.3), Vec3(0.7, 0, 1), Vec3(-0.7, 0, 1)})
    for (const double tilt : {0.0, 1e-12, 3e-8, -3e-8})
      for (const double gap : {1e-3, 1e-10, 0.0, -1e-10, -1e-3}) {
        const Quat turn = rotationAbout(Vec3(1, 0, 2).normalized(), tilt);
        expectFace({box, box, {}, {turn, place + (0.6 + gap) * up}}, turn * up);
        expectFace({drum, box, {}, {turn, 0.7 * place + (0.7 + gap) * up}}, turn * up);
        expectFace({box, drum, {}, {turn, 0.7 * place + (0.7 + gap) * up}}, turn * up);
      }
  // Tilted by 1 degree and 0.1 m apart over a face, a corner is nearest along that face's normal all the same.
  const CorePair tilted{box, box, {}, {rotationAbout(Vec3(1, 0, 2).normalized(), 0.017), Vec3(0, 0.75, 0)}};
  EXPECT_LT((contactAxis(tilted.a, tilted.b).normal - Vec3::UnitY()).norm(), 1e-9);
}

// Corners that meet see no gap along a whole fan of normals: the one taken is that between the corners of the boxes
// moved apart along the line of their middles, here along the line itself. An edge on an edge: across both.
TEST(ContactAxis, OfCornersThatMeetIsAlongTheLineOfTheMiddles) {
  const SampleCore box = boxCore("box", Vec3(1, 0.5, 1.5));
  for (const Vec3& place : {Vec3(1, 0.5, 1.5), Vec3(-1, 0.5, -1.5), Vec3(1, 0.5, 0), Vec3(-1, 0, 1.5)})
    for (const double shift : {0.0, 1e-10, -1e-10}) {
      const CorePair pair{box, box, {}, {Quat::Identity(), (1 + shift) * place}};
      const SeparatingAxis found = contactAxis(pair.a, pair.b), back = contactAxis(pair.b, pair.a);
      EXPECT_NEAR(found.separation, shift * place.norm(), kSeparationRounding) << shift;
      EXPECT_LT((found.normal - place.normalized()).norm(), 1e-9) << place.transpose();
      EXPECT_LT((back.normal + place.normalized()).norm(), 1e-9) << place.transpose();
    }
}

// Corners or rims of mirror images that are next to each other, apart or overlapping: faces see a gap that is hardly
// smaller, two of them the same one, but nothing is over them. The normal is that across the mirror x = 0, and hardly
// changes when one of them moves a little.
TEST(ContactAxis, OfMirrorImagesNextToEachOtherIsAcrossTheMirror) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4)), drum = cylinderCore("drum", 0.5, 0.8);
  for (const SampleCore* sample : {&box, &drum})
    for (const double tilt : {0.05, 0.3, 0.7})
      for (const double gap : {1e-6, 1e-7, 3e-8, 3e-9, -3e-9, -1e-7, -1e-6, -3e-5}) {
        const double upright = sample == &drum ? M_PI / 2 : 0;  // to its end
        const Quat turn = rotationAbout(Vec3::UnitZ(), upright + tilt) * rotationAbout(Vec3::UnitX(), 0.1);
        const Quat image(turn.w(), turn.x(), -turn.y(), -turn.z());
        const Vec3 middle((sample->supportValue(turn.conjugate() * Vec3::UnitX()) + gap / 2), 0, 0);
        const CorePair pair{*sample, *sample, {turn, -middle}, {image, middle}},
            moved{*sample, *sample, {turn, -middle}, {image, middle + Vec3(0, 1e-6 * std::abs(gap), 0)}};
        const SeparatingAxis found = contactAxis(pair.a, pair.b);
        SCOPED_TRACE(::testing::Message() << sample->name << ' ' << tilt << ' ' << gap);
        EXPECT_NEAR(found.separation, gap, 1e-14);
        EXPECT_LT((found.normal - Vec3::UnitX()).norm(), 1e-6);
        EXPECT_LT((contactAxis(moved.a, moved.b).normal - found.normal).norm(), 1e-4);
      }
}

// Crossing edges that see a larger gap than any face are what touches, overlapping or apart.
TEST(ContactAxis, OfCrossingEdgesIsAcrossBoth) {
  const SampleCore bar = boxCore("bar", Vec3(1, 1, 6));
  const Quat onEdge = rotationAbout(Vec3::UnitZ(), M_PI / 4), across = rotationAbout(Vec3::UnitY(), M_PI / 2) * onEdge;
  for (const double shift : {-0.02, -1e-8, 1e-8, 0.02}) {
    const CorePair pair{bar, bar, {onEdge, Vec3::Zero()}, {across, Vec3(0.1, std::sqrt(2) + shift, 0.2)}};
    const SeparatingAxis found = contactAxis(pair.a, pair.b);
    EXPECT_NEAR(found.separation, shift, 4 * kSeparationRounding);
    EXPECT_LT((found.normal - Vec3::UnitY()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace cradle

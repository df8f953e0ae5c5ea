#include "dynamics/free_rotation.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dynamics/free_bodies.h"
#include "rounding.h"

namespace cradle {
namespace {

Vec3 momentumOf(const Case& body, const RotationState& state) {
  const Quat& q = state.worldFromBody;
  return q * (body.inertiaTensor * (q.conjugate() * state.angularVelocity));
}
double energyOf(const Case& body, const RotationState& state) {
  return 0.5 * state.angularVelocity.dot(momentumOf(body, state));
}

struct Reference {
  double time;
  Quat worldFromBody;
  Vec3 angularVelocity;
};

// Moments 1, 2, 3 and a start next to the unstable axis: the body flips over every 3.9 s. Values of Landau and
// Lifshitz's solution, by quadrature to 40 digits.
const std::vector<Reference> kFlippingBody = {
    {1,
     {-0.800856209897268, 0.008820532544950998, 0.5976675636736157, 0.03667441352020474},
     {0.0707714574670425, 5.0022600509603015, -0.10759388317580375}},
    {2,
     {0.2427029909195723, 0.11814412672544591, -0.8227201467472117, -0.5002687114493791},
     {2.5462365665185906, 4.989136841733404, -0.05786830439980161}},
    {5,
     {0.023930572669793215, -0.8308353434911309, -0.03185424271762245, -0.5550903232074553},
     {-0.008150975921709824, 4.9962886181926285, 0.31680911246531984}},
    {10,
     {0.2703823564831435, 0.09157890546009151, -0.6523342775787159, -0.7021158563037933},
     {2.81228342822234, 4.997080577238532, -0.676132958642938}},
    {50,
     {0.06134942840737899, -0.38449973588942377, -0.03859995139790928, -0.9202750917454684},
     {0.134936817581526, 5.005581743228959, -0.35042848779108837}},
};

// The error at t = 50 s is 201.7 times that of the start (the largest entry of the derivative); it grows in proportion
// to time. Start and moments are as if rounded once.
TEST(FreeRotation, FlippingBodyMatchesTheExactSolution) {
  const FreeRotation rotation(Vec3(1, 2, 3).asDiagonal(), {Quat::Identity(), {0.05, 5, 0.05}});
  for (const auto& [time, worldFromBody, angularVelocity] : kFlippingBody) {
    const double tolerance = (4 + 201.7 * time / 50) * kEpsilon;
    EXPECT_LE(distance(rotation.at(time).worldFromBody, worldFromBody), tolerance) << time;
    EXPECT_LE((rotation.at(time).angularVelocity - angularVelocity).norm(), 5 * tolerance) << time;
  }
}

// A box of 1.0 x 0.6 x 0.2 m, 4e-6 from the separatrix. The references are a Runge-Kutta integration in long double,
// good to 1e-12.
TEST(FreeRotation, BoxNextToTheSeparatrixMatchesAnIntegrationInLongDouble) {
  const FreeRotation rotation(Vec3(0.4 / 12, 1.04 / 12, 1.36 / 12).asDiagonal(), {Quat::Identity(), {0.01, 2, 0.01}});
  const Quat at5(0.27862428776940469, 0.01452397861208810, -0.94169823109638361, -0.18804787119297487);
  const Quat at20(0.91299440034513210, -0.02676327986032762, 0.40594789521804807, 0.03051652269815690);
  EXPECT_LE(distance(rotation.at(5).worldFromBody, at5), 1e-12);
  EXPECT_LE(distance(rotation.at(20).worldFromBody, at20), 1e-12);
}

TEST(FreeRotation, StartsWhereItIsTold) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const Case body = anyBody(random);
    const RotationState state = FreeRotation(body.inertiaTensor, body.start).at(0);
    EXPECT_LE(distance(state.worldFromBody, body.start.worldFromBody), 20 * kEpsilon);
    EXPECT_LE((state.angularVelocity - body.start.angularVelocity).norm(), 20 * kEpsilon);
  }
}

// A dozen rotations and products of numbers of size 1, each rounded once; the moments differ by 10 at most.
TEST(FreeRotation, AngularMomentumAndEnergyAreConstantToRoundingAtAnyTime) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const Case body = anyBody(random);
    const FreeRotation rotation(body.inertiaTensor, body.start);
    const Vec3 momentum = momentumOf(body, body.start);
    const double energy = energyOf(body, body.start);
    for (const double scale : {1.0, 1e3, 1e9}) {
      const RotationState state = rotation.at(random.between(0, scale));
      EXPECT_LE((momentumOf(body, state) - momentum).norm(), 40 * kEpsilon * momentum.norm());
      EXPECT_NEAR(energyOf(body, state), energy, 40 * kEpsilon * energy);
    }
  }
}

// Moments 1, 1.5, 3 have 1/I1 - 1/I2 = 1/I2 - 1/I3, so that M1 = M3 is on the separatrix: m_2 = tanh(rate t). With M =
// (1, 0, 1) M2' = (1/I1 - 1/I3) M1 M3 = 2/3 > 0 at the start.
TEST(FreeRotation, OnTheSeparatrixApproachesTheMiddleAxisAsHyperbolicTangent) {
  const Case body = straight({1, 1.5, 3}, {1, 0, 1.0 / 3});
  const FreeRotation rotation(body.inertiaTensor, body.start);
  const double momentum = std::sqrt(2.0), rate = momentum / 3;
  for (const double time : {0.1, 1.0, 5.0, 30.0}) {
    const RotationState state = rotation.at(time);
    const Vec3 inBody = state.worldFromBody.conjugate() * state.angularVelocity;
    EXPECT_NEAR(1.5 * inBody.y(), momentum * std::tanh(rate * time), 1e-14 * (1 + time));
    EXPECT_NEAR(inBody.x(), 1 / std::cosh(rate * time), 1e-14 * (1 + time));
  }
}

// With I1 = I2 the body turns about the angular momentum at |L| / I1, and in itself about its axis at (1 - I3 / I1) w3.
TEST(FreeRotation, SymmetricBodyPrecessesAtConstantRates) {
  for (const Vec3& moments : {Vec3(2, 2, 3), Vec3(2, 2, 0.5)}) {
    const Vec3 spin(0.3, -0.8, 1.1), momentum = moments.cwiseProduct(spin);
    const FreeRotation rotation(moments.asDiagonal(), {Quat::Identity(), spin});
    for (const double time : {0.5, 7.0, 1000.0}) {
      const Quat expected = rotationAbout(momentum, momentum.norm() / 2 * time) *
                            rotationAbout(Vec3::UnitZ(), (1 - moments.z() / 2) * spin.z() * time);
      EXPECT_LE(distance(rotation.at(time).worldFromBody, expected), 4 * kEpsilon * (2 + time));
    }
  }
}

TEST(FreeRotation, SphereTurnsAtConstantRate) {
  const Vec3 spin(0.3, -0.8, 1.1);
  const FreeRotation rotation(2 * Mat3::Identity(), {Quat::Identity(), spin});
  EXPECT_LE(distance(rotation.at(50).worldFromBody, rotationAbout(spin, 50 * spin.norm())), 50 * kEpsilon);
  EXPECT_EQ(rotation.at(50).angularVelocity, spin);
}

TEST(FreeRotation, RotationAboutAPrincipalAxisStaysAboutIt) {
  for (int axis = 0; axis < 3; ++axis) {
    const FreeRotation rotation(Vec3(1, 2, 3).asDiagonal(), {Quat::Identity(), 2 * Vec3::Unit(axis)});
    EXPECT_LE(distance(rotation.at(1e3).worldFromBody, rotationAbout(Vec3::Unit(axis), 2e3)), 1e3 * kEpsilon);
    EXPECT_EQ(rotation.at(1e3).angularVelocity, Vec3(2 * Vec3::Unit(axis)));
  }
}

TEST(FreeRotation, BodyAtRestStays) {
  const Quat orientation = rotationAbout({1, 2, 3}, 0.7);
  const RotationState state = FreeRotation(Vec3(1, 2, 3).asDiagonal(), {orientation, Vec3::Zero()}).at(10);
  EXPECT_LE(distance(state.worldFromBody, orientation), kEpsilon);
  EXPECT_EQ(state.angularVelocity, Vec3(0, 0, 0));
}

// A restart rounds the state once, 1e-16, and ten seconds at 2 rad/s and less let that grow a hundredfold or so.
TEST(FreeRotation, RestartGoesOnWithTheSameMotion) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const Case body = anyBody(random);
    const FreeRotation whole(body.inertiaTensor, body.start);
    const double first = random.between(0, 10), second = random.between(0, 10);
    const RotationState end = FreeRotation(body.inertiaTensor, whole.at(first)).at(second);
    EXPECT_LE(distance(end.worldFromBody, whole.at(first + second).worldFromBody), 2e-13);
  }
}

// 64-bit FNV-1a over the bits of orientations: it must not change with compiler, processor or optimisation.
TEST(FreeRotation, ResultsHaveTheSameBitsEverywhere) {
  Random random;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (int i = 0; i < 200; ++i) {
    const Case body = anyBody(random);
    const FreeRotation rotation(body.inertiaTensor, body.start);
    for (const double time : {0.1, 3.0, 1e3, 1e8}) {
      const Quat orientation = rotation.at(time).worldFromBody;
      for (const double part : orientation.coeffs()) {
        const auto bits = std::bit_cast<std::uint64_t>(part);
        for (int shift = 0; shift < 64; shift += 8) hash = (hash ^ (bits >> shift & 0xff)) * 0x100000001b3;
      }
    }
  }
  EXPECT_EQ(hash, 11201368914757260607u);
}

TEST(FreeRotation, ExtremeInputsGiveAUnitQuaternionAndAFiniteVelocity) {
  const std::vector<double> sizes{0, 1, -1, 1e-20, -1e-60, 1e-119, 1e-121, 1e-160, 1e-300, 5e-324, 1e5, 1e100};
  const std::vector<double> moments{1, 1 + kEpsilon, 2, 1e-12, 1e6, 1e-30};
  std::vector<Vec3> spins;
  for (const double x : sizes)
    for (const double y : sizes)
      for (const double z : sizes) spins.emplace_back(x, y, z);
  for (const double second : moments) {
    for (const double third : moments) {
      for (const Vec3& spin : spins) {
        const FreeRotation rotation(Vec3(1, second, third).asDiagonal(), {Quat::Identity(), spin});
        for (const double time : {0.0, 1e-300, 1.0, 400.0, 1e18, 1e300}) {
          const RotationState state = rotation.at(time);
          ASSERT_NEAR(state.worldFromBody.norm(), 1, 4 * kEpsilon) << spin.transpose() << ' ' << second << ' ' << third;
          ASSERT_TRUE(state.angularVelocity.allFinite()) << spin.transpose() << ' ' << second << ' ' << third;
        }
      }
    }
  }
}

}  // namespace
}  // namespace cradle

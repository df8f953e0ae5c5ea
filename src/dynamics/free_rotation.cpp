#include "dynamics/free_rotation.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "math/elementary.h"
#include "math/rotation.h"

// The attitude is worldFromMomentum Rz(chi) A(m): A(m) is the smallest rotation that takes the direction m of the
// angular momentum in the body to axis 3. As m_3 >= 0 on a polhode round axis 3, A has no singularity, unlike Euler's
// angles. The body's spin then asks for chi' = |L| (2T/L^2 + h_3 m_3) / (1 + m_3), h_3 = 1/I_3. With m_3 = a dn u this
// is an elliptic function of u whose poles, 1 + a dn u = 0, are simple, with residues +-i, at u = 2 i K' +- i y, a dn(i
// y) = 1: its integral is a mean rate times t plus twice the phase of theta_4(z - i pi y / (2 K)), z = pi u / (2 K), of
// periods 2 K and 4 i K' (E. Whittaker, G. Watson, "A Course of Modern Analysis", 21.5 and 22.74). R. van Zon and J.
// Schofield, "Numerical implementation of the exact dynamics of free rigid bodies", J. Comput. Phys. 225, 2007, do the
// same for Euler's angles.

namespace cradle {
namespace {

using std::numbers::pi;

QuarterPeriods quarterPeriods(const Polhode& polhode, const JacobiElliptic& elliptic) {
  constexpr double kMinModulus = 1e-145;  // with less, every term that has K' in it vanishes
  if (polhode.modulus < kMinModulus) return {elliptic.quarterPeriod(), std::numeric_limits<double>::infinity()};
  return {elliptic.quarterPeriod(), JacobiElliptic(polhode.modulus).quarterPeriod()};
}

/// Imaginary argument y at which a dn(i y) = 1: of modulus k', sn y = b_1 / b_2, cn y = a k / b_2, dn y = k / b_2.
ThetaPhase thetaOf(const Polhode& polhode, const QuarterPeriods& periods) {
  if (periods.imaginary == std::numeric_limits<double>::infinity()) return {periods, 0};
  const double b1 = polhode.amplitude[0], b2 = polhode.sense * polhode.amplitude[1], a = polhode.amplitude[2];
  const double y = ellipticArgument({b1 / b2, a * polhode.modulus / b2, polhode.modulus / b2});
  return {periods, std::min(y, periods.imaginary)};
}

/// An angle that stays finite however long one waits.
double angleAfter(double time, double rate) {
  constexpr double kMax = 1e300;  // rad: sums of two do not overflow
  return std::clamp(rate * time, -kMax, kMax);
}

}  // namespace

FreeRotation::Wobble::Wobble(const Polhode& polhode, const Quat& worldFromBody)
    : polhode_(polhode), elliptic_(polhode.complement), theta_(thetaOf(polhode, quarterPeriods(polhode, elliptic_))) {
  const double phasePerArgument = pi / (2 * elliptic_.quarterPeriod());
  phaseAtStart_ = polhode.argument * phasePerArgument;
  phaseRate_ = polhode.rate * phasePerArgument;
  const double a = polhode.amplitude[2];
  const double alongMomentum = polhode.inverseMoments.dot(polhode.start.cwiseAbs2());  // 2T / L^2
  const double rateAtZero = polhode.momentum * (alongMomentum + polhode.inverseMoments[2] * a) / (1 + a);
  precessionRate_ = rateAtZero / 2 - polhode.sense * phaseRate_ * theta_.slopeAtZero();
  worldFromMomentum_ = worldFromBody * polhode.bodyFromAxes * momentumFromAxes(polhode.start, 0).conjugate();
}

Vec3 FreeRotation::Wobble::momentumDirection(double phase) const {
  const JacobiElliptic::Values values = elliptic_.at(sinCos(phase));
  return polhode_.amplitude.cwiseProduct(Vec3(values.cn, values.sn, values.dn)).normalized();
}

Quat FreeRotation::Wobble::momentumFromAxes(const Vec3& direction, double time) const {
  const ThetaPhase::Direction wave = theta_.at(phaseAtStart_ + angleAfter(time, phaseRate_));
  const SinCos turn = sinCos(angleAfter(time, precessionRate_));
  const double waveSine = polhode_.sense * wave.imaginary;
  const Quat precession(turn.cos * wave.real - turn.sin * waveSine, 0, 0, turn.sin * wave.real + turn.cos * waveSine);
  const Quat tilt(1 + direction.z(), direction.y(), -direction.x(), 0);
  return precession * tilt.normalized();
}

RotationState FreeRotation::Wobble::at(double time) const {
  const Vec3 direction = momentumDirection(phaseAtStart_ + angleAfter(time, phaseRate_));
  const Quat worldFromAxes = (worldFromMomentum_ * momentumFromAxes(direction, time)).normalized();
  const Vec3 spin = polhode_.momentum * polhode_.inverseMoments.cwiseProduct(direction);
  return {worldFromAxes * polhode_.bodyFromAxes.conjugate(), worldFromAxes * spin};
}

FreeRotation::FreeRotation(const Mat3& inertiaTensor, const RotationState& start)
    : start_{start.worldFromBody.normalized(), start.angularVelocity} {
  const Vec3 bodySpin = start_.worldFromBody.conjugate() * start_.angularVelocity;
  if (const auto polhode = polhodeOf(inertiaTensor, inertiaTensor * bodySpin))
    wobble_.emplace(*polhode, start_.worldFromBody);
}

RotationState FreeRotation::at(double time) const {
  if (wobble_) return wobble_->at(time);
  const double speed = start_.angularVelocity.stableNorm();
  if (speed == 0) return start_;
  const Quat turn = rotationAbout(start_.angularVelocity / speed, angleAfter(time, speed));
  return {(turn * start_.worldFromBody).normalized(), start_.angularVelocity};
}

}  // namespace cradle

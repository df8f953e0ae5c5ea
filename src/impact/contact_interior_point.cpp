// A primal-dual interior point method with the scaling of Nesterov and Todd and Mehrotra's corrector, on the
// second-order frictional contact problem of V. Acary, P. Armand, H. M. Nguyen, M. Shpakovych, "Second-order cone
// programming for frictional contact mechanics using interior point algorithm", Optim. Methods Softw. 2022. De Saxce's
// correction s = mu |u_t| is part of the residual G z + g + s - w of an iterate, and of the derivatives of the next
// step. |u_t| has a corner where a contact begins to slide, at which steps would get stuck; it is rounded off to
// sqrt(|u_t|^2 + r^2) - r, where the radius r falls with the complementarity.

#include "impact/contact_interior_point.h"

#include <algorithm>
#include <cmath>

#include "impact/lorentz_cone.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr int kMaxInteriorIterations = 40;  // about twenty are usual; half or twice as many change no test
// Of the squared largest free velocity: complementarity of impulses and velocities that are 1e-11 of it, which is
// rounding.
constexpr double kMinComplementarity = 1e-22;
// Of the way to the boundary of the cones that a step goes: the usual choice; 0.9 changes no test.
constexpr double kBoundaryFraction = 0.99;
// Of the root of complementarity: radius of the rounded corner of |u_t|. A tenth or ten times as much changes no test.
constexpr double kSmoothingRatio = 0.1;
// A shorter step (1: a full one) is taken again, towards the central path. If all are, redundant contacts are not
// solved.
constexpr double kCenteringLength = 0.1;
constexpr double kMinStepLength = 1e-8;  // a shorter step leads nowhere: the search has failed
constexpr double kNoDivisionByZero = 1e-300;

/// One contact: impulses x and velocities y in the Lorentz cone; without friction only the normal parts.
struct Pair {
  Vec3 x = Vec3::UnitZ(), y = Vec3::UnitZ();  // (z_t, mu z_n) and (w_t, w_n / mu)
  double friction = 0;                        // mu
  Vec3 affineX = Vec3::Zero(), affineY = Vec3::Zero(), dx = Vec3::Zero(), dy = Vec3::Zero();
  ConeScaling scaling;
  Vec3 middle = Vec3::Zero();  // W y = W^-1 x

  bool isFree() const { return friction == 0; }
  double unit() const { return isFree() ? 1 : friction; }
  Vec3 toZ(const Vec3& ofX) const { return {ofX.x(), ofX.y(), ofX.z() / unit()}; }
  Vec3 impulse() const { return toZ(x); }
  Vec3 velocity() const { return {y.x(), y.y(), y.z() * unit()}; }
  Vec3 toX(const Vec3& z) const { return {z.x(), z.y(), z.z() * unit()}; }
  Vec3 toY(const Vec3& w) const { return {w.x(), w.y(), w.z() / unit()}; }
  double product() const { return isFree() ? x.z() * y.z() : x.dot(y); }

  void scale() {
    if (isFree()) return;
    scaling = coneScaling(x, y);
    middle = scaling.scale * y;
  }
  /// H with dz = c - H dw.
  Mat3 stiffness() const {
    if (isFree()) return Vec3(0, 0, x.z() / y.z()).asDiagonal();
    const Vec3 units(1, 1, 1 / friction);
    return units.asDiagonal() * (scaling.scale * scaling.scale) * units.asDiagonal();
  }
  /// c that aims at complementarity `target`, with Mehrotra's correction if there was an affine step.
  Vec3 aim(double target, bool correct) const {
    if (isFree()) return {0, 0, (target - (correct ? affineX.z() * affineY.z() : 0)) / y.z() - x.z()};
    if (!correct) return toZ(-x);
    Vec3 side = -coneProduct(middle, middle) - coneProduct(scaling.inverse * affineX, scaling.scale * affineY);
    side.z() += target;
    return toZ(scaling.scale * coneQuotient(side, middle));
  }
  double longestStep() const {
    if (!isFree()) return std::min(stepToBoundary(x, dx), stepToBoundary(y, dy));
    const double ofX = dx.z() < 0 ? -x.z() / dx.z() : INFINITY, ofY = dy.z() < 0 ? -y.z() / dy.z() : INFINITY;
    return std::min(ofX, ofY);
  }
};

class InteriorPoint {
 public:
  InteriorPoint(const ScaledContacts& cones, const DelassusOperator& op, const VectorX& impulses);
  int run(double tolerance, VectorX& impulses);

 private:
  double gap() const;
  void findResidual();
  double offCoulomb() const;
  double slidingSpeed(const Eigen::Vector2d& slip) const {
    return std::sqrt(slip.squaredNorm() + smoothing_ * smoothing_) - smoothing_;
  }
  Mat3 correction(std::size_t pair) const;
  double step(double target, bool correct);

  const VectorX& free_;
  const DelassusOperator& op_;
  std::vector<Pair> pairs_;
  std::vector<ContactEquation> equations_;
  VectorX z_, velocities_, residual_, side_;
  double unit_ = 1;       // scaled velocity: the largest free one
  double smoothing_ = 0;  // scaled velocity: radius that rounds off the corner of |u_t| at 0
};

InteriorPoint::InteriorPoint(const ScaledContacts& cones, const DelassusOperator& op, const VectorX& impulses)
    : free_(cones.free), op_(op), equations_(cones.frictions.size()), z_(impulses.size()), side_(impulses.size()) {
  unit_ = std::max(cones.free.cwiseAbs().maxCoeff(), kNoDivisionByZero);
  pairs_.resize(cones.frictions.size());
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    pairs_[i].x = pairs_[i].y = unit_ * Vec3::UnitZ();
    pairs_[i].friction = cones.frictions[i];
  }
}

double InteriorPoint::gap() const {
  double sum = 0;
  for (const Pair& pair : pairs_) sum += pair.product();
  return sum / static_cast<double>(pairs_.size());
}

/// Computes the residual G z + g + s - w, with De Saxce's correction s of the present velocities.
void InteriorPoint::findResidual() {
  for (std::size_t i = 0; i < pairs_.size(); ++i) z_.segment<3>(3 * static_cast<Index>(i)) = pairs_[i].impulse();
  velocities_ = op_.multiply(z_) + free_;
  residual_ = velocities_;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Pair& pair = pairs_[i];
    if (pair.isFree()) {
      residual_[at + 2] -= pair.y.z();
      continue;
    }
    residual_[at + 2] += pair.friction * slidingSpeed(residual_.segment<2>(at));
    residual_.segment<3>(at) -= pair.velocity();
  }
}

/// The residual of the contact that is farthest from Coulomb's law.
double InteriorPoint::offCoulomb() const {
  double worst = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    const Vec3 error = coulombResidual(z_.segment<3>(at), velocities_.segment<3>(at), pairs_[i].friction);
    if (!error.allFinite()) return INFINITY;
    worst = std::max(worst, error.cwiseAbs().maxCoeff());
  }
  return worst;
}

/// The derivative of a contact's corrected velocity, u + (0, 0, s), by its velocity u.
Mat3 InteriorPoint::correction(std::size_t i) const {
  Mat3 derivative = Mat3::Identity();
  const Eigen::Vector2d slip = velocities_.segment<2>(3 * static_cast<Index>(i));
  const double speed = std::sqrt(slip.squaredNorm() + smoothing_ * smoothing_);
  if (speed > 0) derivative.bottomLeftCorner<1, 2>() = pairs_[i].friction / speed * slip.transpose();
  return derivative;
}

/// Finds the directions dx and dy of a step towards complementarity `target`. Returns the longest step along them, at
/// most 1, that stays in the cones.
double InteriorPoint::step(double target, bool correct) {
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    side_.segment<3>(at) = pairs_[i].aim(target, correct) - pairs_[i].stiffness() * residual_.segment<3>(at);
  }
  VectorX du;
  const VectorX dz = op_.solve(side_, &du);
  double longest = 1;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Index at = 3 * static_cast<Index>(i);
    Pair& pair = pairs_[i];
    pair.dx = pair.toX(dz.segment<3>(at));
    pair.dy = pair.toY(correction(i) * du.segment<3>(at) + residual_.segment<3>(at));
    longest = std::min(longest, pair.longestStep());
  }
  return longest;
}

int InteriorPoint::run(double tolerance, VectorX& impulses) {
  int iteration = 0;
  double least = INFINITY;
  for (; iteration < kMaxInteriorIterations; ++iteration) {
    const double complementarity = gap();
    smoothing_ = kSmoothingRatio * std::sqrt(complementarity);
    findResidual();
    const double off = offCoulomb();
    if (off < least) impulses = z_, least = off;
    if (!(off < INFINITY) || off <= tolerance || complementarity <= kMinComplementarity * unit_ * unit_) break;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      pairs_[i].scale();
      equations_[i].ofVelocity = pairs_[i].stiffness() * correction(i);
    }
    op_.factorize(equations_);
    const double affine = step(0, false);
    for (Pair& pair : pairs_) pair.affineX = pair.dx, pair.affineY = pair.dy;
    const double left = 1 - affine, centering = left * left * left;
    double length = kBoundaryFraction * step(centering * complementarity, true);
    if (length < kCenteringLength) {  // too near the boundary: back to the central path
      for (Pair& pair : pairs_) pair.affineX.setZero(), pair.affineY.setZero();
      length = kBoundaryFraction * step(complementarity, true);
    }
    if (!(length > kMinStepLength)) break;
    for (Pair& pair : pairs_) pair.x += length * pair.dx, pair.y += length * pair.dy;
  }
  return iteration;
}

}  // namespace

int solveByInteriorPoint(const ScaledContacts& cones, const DelassusOperator& op, double tolerance, VectorX& impulses) {
  return InteriorPoint(cones, op, impulses).run(tolerance, impulses);
}

}  // namespace cradle

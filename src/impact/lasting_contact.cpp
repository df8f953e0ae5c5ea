#include "impact/lasting_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr int kMostSweeps = 1000;         // heavy on light converges slowly: the study shows how slowly
constexpr double kConvergedPart = 1e-12;  // of the largest change of a sweep
constexpr double kRoundingPart = 4e-15;   // of the speeds of the points that touch: rounding never converges
constexpr int kMostOverlapSweeps = 20;
constexpr double kOverlapLeft = 1e-15;  // m

/// The nearest impulse with a normal part >= 0 and a tangential part <= friction times it (not the projection onto the
/// cone: the normal part is kept, as Coulomb's law asks).
Vec3 clampToCone(const Vec3& impulse, const Vec3& normal, double friction) {
  const double pressing = std::max(0.0, impulse.dot(normal));
  const Vec3 tangential = impulse - impulse.dot(normal) * normal;
  const double size = tangential.norm(), most = friction * pressing;
  return pressing * normal + (size > most ? most / size : 1.0) * tangential;
}

/// The faster of the two points that touch, in m/s.
double pointSpeed(const Contact& contact, const VectorX& state) {
  Contact ofA = contact, ofB = contact;
  ofA.bodyB = ofB.bodyA = kFixed;
  return std::max(relativeVelocity(ofA, state).norm(), relativeVelocity(ofB, state).norm());
}

/// One contact's turn: normal part first, then friction under the pressure that it left.
double relax(LastingContact& lasting, const Mat3& inverseMass, const ImpulseResponse& response, VectorX& state) {
  const Contact& contact = lasting.contact;
  const Vec3& normal = contact.normal;
  const Vec3 velocity = relativeVelocity(contact, state);
  const double normalResponse = normal.dot(inverseMass * normal);
  const double tangentResponse = std::max(1e-300, inverseMass.trace() - normalResponse);  // bounds both eigenvalues
  const Vec3 sliding = velocity - velocity.dot(normal) * normal;

  const Vec3 free = lasting.impulse - velocity.dot(normal) / normalResponse * normal - sliding / tangentResponse;
  const Vec3 held = clampToCone(free, normal, lasting.friction);
  const Vec3 change = held - lasting.impulse;
  lasting.impulse = held;
  response.apply(contact, change, state);
  return (inverseMass * change).norm();
}

}  // namespace

double solveLastingContacts(std::vector<LastingContact>& contacts, const ImpulseResponse& response, VectorX& state) {
  std::vector<Mat3> inverseMasses;
  for (const LastingContact& lasting : contacts)
    inverseMasses.push_back(response.inverseMassAt(lasting.contact, state));
  double largest = 0, change = 0, rounding = 0;
  for (const LastingContact& lasting : contacts)
    rounding = std::max(rounding, kRoundingPart * pointSpeed(lasting.contact, state));
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    change = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i)
      change = std::max(change, relax(contacts[i], inverseMasses[i], response, state));
    largest = std::max(largest, change);
    if (largest <= rounding || change <= kConvergedPart * largest) break;
  }
  return change;
}

void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state) {
  std::vector<std::size_t> pairs;
  for (const Contact& contact : contacts)
    if (pairs.empty() || pairs.back() != contact.pair) pairs.push_back(contact.pair);
  std::vector<Contact> overlaps;
  for (int sweep = 0; sweep < kMostOverlapSweeps; ++sweep) {
    double deepest = 0;
    for (const std::size_t pair : pairs) {
      overlaps.clear();
      appendContacts(geometry, pair, state, 0, overlaps);
      // What earlier contacts of the same bodies did since it was found is seen in the next sweep.
      for (const Contact& overlap : overlaps) {
        deepest = std::max(deepest, -overlap.separation);
        const double inverseMass = overlap.normal.dot(response.inverseMassAt(overlap, state) * overlap.normal);
        response.displace(overlap, -overlap.separation / inverseMass * overlap.normal, state);
      }
    }
    if (deepest <= kOverlapLeft) return;
  }
}

}  // namespace cradle

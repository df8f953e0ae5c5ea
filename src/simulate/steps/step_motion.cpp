#include "simulate/steps/step_motion.h"

#include <cmath>

#include "simulate/limit_events.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

constexpr double kFreeClosing = 2;  // of the speed with which a contact strikes: nothing makes it so fast

/// Moves a contact between the sides of two capsules, whose gap is smooth, to where it is found in the step's middle.
/// With the gaps s in the middle and s0 at the start, and the derivative s' in the middle, s - s0 = s' h/2 - s'' h^2/8.
/// Returns s'' n (m/s^2, world), the velocity product of the contact. Zero for edges of other shapes.
Vec3 followSides(const ContactSet& contacts, const FreeStep& step, Contact& contact) {
  const ContactGeometry& geometry = contacts.assembly().geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const auto isCapsule = [&](std::size_t i) { return geometry.colliders[i].kind() == ColliderKind::capsule; };
  const double half = 0.5 * step.timeStep, speed = relativeVelocity(contact, step.middle).norm();
  const bool areCapsules = !pair.againstPlane && isCapsule(pair.a) && isCapsule(pair.b);
  if (!areCapsules || half * speed < contacts.tolerances().minFollowedWay()) return Vec3::Zero();
  std::vector<Contact> found;
  appendContacts(geometry, contact.pair, step.middle, std::max(0.0, contact.separation) + half * speed, found);
  const Contact* nearest = nullptr;
  for (const Contact& other : found)
    if (!nearest || (other.point - contact.point).squaredNorm() < (nearest->point - contact.point).squaredNorm())
      nearest = &other;
  if (!nearest || nearest->normal.dot(contact.normal) < StepTolerances::kSameFeature) return Vec3::Zero();
  const double derivative = openingSpeed(*nearest, step.middle), gap = contact.separation;
  const double product = 2 * (derivative - (nearest->separation - gap) / half);  // m/s: s'' h/2
  if (std::abs(product) > speed) return Vec3::Zero();
  contact = *nearest;
  contact.separation = gap;
  return product / half * contact.normal;
}

/// Moves a member's contact from the step's start to its middle. Returns its velocity product (dJ/dt) v (m/s^2, world).
Vec3 followMember(const ContactSet& contacts, std::size_t member, const FreeStep& step, Contact& contact) {
  if (const Limit* rope = contacts.ropeOf(member)) {
    contact = LimitEvents::contactOf(*rope, step.middle).contact;
    return -lengtheningAcceleration(*rope, step.middle, VectorX::Zero(step.middle.size())) * contact.normal;
  }
  const Vec3 product = followContact(step.before, step.middle, step.frames, contact);
  return canLast(contact) ? product : followSides(contacts, step, contact);
}

}  // namespace

FreeStep::FreeStep(const std::vector<RigidBody>& bodies, const VectorX& start, double length, const VectorX& freeEnd)
    : before(start), timeStep(length), end(freeEnd), middle(start) {
  for (Eigen::Index body = 0; body < bodyCount(before); ++body) {
    centerOfMass(middle, body) += 0.5 * timeStep * linearVelocity(before, body);
    turnBody(middle, body, 0.5 * timeStep * angularVelocity(before, body));
  }
  findBodyFrames(bodies, middle, frames);
}

void copyBodies(const std::vector<int>& bodies, const VectorX& from, VectorX& to) {
  for (const int body : bodies) {
    to.segment<kPoseSize>(body * kPoseSize) = from.segment<kPoseSize>(body * kPoseSize);
    to.segment<kVelocitySize>(velocityOffset(to, body)) = from.segment<kVelocitySize>(velocityOffset(to, body));
  }
}

StepMotion stepMotionOf(const StepGroup& group, const ContactSet& contacts, const FreeStep& step,
                        GroupProblem& problem) {
  std::vector<Contact> inMiddle = group.contacts;
  std::vector<Vec3> products;  // m/s^2, world
  for (std::size_t i = 0; i < inMiddle.size(); ++i)
    products.push_back(followMember(contacts, group.members[i], step, inMiddle[i]));
  problem.set(group, inMiddle, step.middle);
  StepMotion motion{problem.velocitiesIn(step.before), problem.velocitiesIn(step.end), VectorX(3 * products.size()),
                    step.timeStep};
  for (std::size_t i = 0; i < products.size(); ++i)
    motion.velocityProduct.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        0.5 * step.timeStep * (problem.axes(i).transpose() * products[i]);
  return motion;
}

/// A contact that opens when the step begins may come back as fast, so that the mean velocity leaves its gap as it was.
ContactProblem posedStep(const StepGroup& group, const ContactSet& contacts, const StepMotion& motion,
                         const std::vector<char>& strikesInside, double restitutionFraction) {
  ContactProblem problem{motion.free + motion.velocityProduct, {}};
  for (std::size_t i = 0; i < group.contacts.size(); ++i) {
    const std::size_t member = group.members[i];
    const Eigen::Index at = 3 * static_cast<Eigen::Index>(i);
    const ContactMaterial& material = contacts.materialOf(member);
    const bool slides = (motion.start - motion.velocityProduct).segment<2>(at).norm() > kSlowestSliding;
    problem.frictions.push_back(slides ? material.dynamicFriction : material.staticFriction);
    const double closing = motion.closing(at + 2), pressing = motion.pressing(at + 2);
    const double gap = std::max(0.0, group.contacts[i].separation);
    const double restitution = restitutionFraction * material.restitution;
    const bool touches = gap + motion.timeStep * problem.free[at + 2] < 0;
    const bool rebounds =
        touches && restitution * closing > contacts.tolerances().maxRestSpeed(pressing, motion.timeStep);
    if (member < strikesInside.size() && strikesInside[member]) {
      problem.free[at + 2] += kFreeClosing * (closing + pressing);
      continue;
    }
    const double returning = std::min(std::max(0.0, -closing), pressing);  // of what opens, and is pressed back
    problem.free[at + 2] += rebounds ? pressing - restitution * closing : gap / motion.timeStep + returning;
    problem.hasRebounds = problem.hasRebounds || rebounds;
  }
  return problem;
}

}  // namespace cradle

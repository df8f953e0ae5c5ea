#include "simulate/steps/contact_set.h"

#include <map>
#include <utility>

#include "constraints/disjoint_sets.h"
#include "simulate/limit_events.h"

namespace cradle {

ContactSet::ContactSet(const Assembly& assembly, const StepTolerances& tolerances, const std::vector<Contact>& contacts,
                       const std::vector<const Limit*>& ropes, const VectorX& before)
    : assembly_(assembly), tolerances_(tolerances), contacts_(contacts) {
  if (contacts.empty()) return;
  for (const Limit* rope : ropes) {
    const ImpactContact contact = LimitEvents::contactOf(*rope, before);
    contacts_.push_back(contact.contact);
    ropes_.push_back(rope), ropeMaterials_.push_back(contact.material);
  }
}

const ContactMaterial& ContactSet::materialOf(std::size_t member) const {
  if (member >= firstRope()) return ropeMaterials_[member - firstRope()];
  return assembly_.geometry.pairs[contacts_[member].pair].material;
}

/// Whether the member is a contact with a fixed plane without friction.
bool ContactSet::isOnSmoothPlane(std::size_t member) const {
  if (ropeOf(member) || materialOf(member).staticFriction > 0 || materialOf(member).dynamicFriction > 0) return false;
  return assembly_.geometry.pairs[contacts_[member].pair].againstPlane;
}

std::vector<StepGroup> ContactSet::findGroups() const {
  const auto isHeld = [this](int body) {  // no force moves it
    return body == kFixed || assembly_.mechanism.bodies[static_cast<std::size_t>(body)].isDriven();
  };
  DisjointSets sets(assembly_.mechanism.bodies);
  std::vector<char> isConstrained(assembly_.mechanism.bodies.size(), 0), isConstrainedToFixed = isConstrained;
  for (const Constraint& constraint : assembly_.mechanism.constraints) {
    const int bodyA = constraint.anchorA.body, bodyB = constraint.anchorB.body;
    sets.join(bodyA, bodyB);
    for (const auto& [body, other] : {std::pair(bodyA, bodyB), {bodyB, bodyA}}) {
      if (body == kFixed) continue;
      isConstrained[static_cast<std::size_t>(body)] = 1;
      if (isHeld(other)) isConstrainedToFixed[static_cast<std::size_t>(body)] = 1;
    }
  }
  for (const Contact& contact : contacts_) sets.join(contact.bodyA, contact.bodyB);
  std::map<int, StepGroup> groups;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i];
    StepGroup& group = groups[sets.islandOf(contact.bodyA, contact.bodyB)];
    group.members.push_back(i);
    group.contacts.push_back(contact);
    if (!isHeld(contact.bodyA) && !isHeld(contact.bodyB)) continue;
    if (isOnSmoothPlane(i))
      hinderByPlane(contact.normal, group.moved.kept);
    else
      group.moved.kept.resize(6, 0);
  }
  for (std::size_t body = 0; body < isConstrained.size(); ++body)
    if (const auto group = groups.find(sets.islandOf(static_cast<int>(body)));
        group != groups.end() && !isHeld(static_cast<int>(body))) {
      group->second.moved.bodies.push_back(static_cast<int>(body));
      if (isConstrainedToFixed[body]) group->second.moved.kept.resize(6, 0);
      group->second.isConstrained = group->second.isConstrained || isConstrained[body];
    }
  std::vector<StepGroup> ordered;
  for (auto& [firstBody, group] : groups) {
    group.firstBody = firstBody;
    ordered.push_back(std::move(group));
  }
  return ordered;
}

}  // namespace cradle

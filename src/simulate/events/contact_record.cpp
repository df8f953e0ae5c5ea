#include "simulate/events/contact_record.h"

#include <algorithm>

namespace cradle {

ContactFallback fallbackAt(std::string_view reason, const std::vector<const Contact*>& contacts,
                           const Assembly& assembly) {
  return {reason, sceneBodiesOf(contacts, assembly)};
}

ContactFallback jamAt(const std::vector<const ContactRecord*>& records, const Assembly& assembly) {
  std::vector<const Contact*> sliding;
  for (const ContactRecord* record : records)
    if (record->slides && record->pair.material.dynamicFriction > 0) sliding.push_back(&record->contact);
  return sliding.empty() ? ContactFallback{} : fallbackAt("friction jams where contacts slide", sliding, assembly);
}

std::vector<int> sceneBodiesOf(const std::vector<const Contact*>& contacts, const Assembly& assembly) {
  std::vector<int> bodies;
  for (const Contact* contact : contacts) {
    const auto [a, b] = bodiesOf(assembly, assembly.geometry.pairs[contact->pair]);
    bodies.push_back(a), bodies.push_back(b);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

bool isSamePair(const ColliderPair& one, const ColliderPair& other) {
  return one.a == other.a && one.b == other.b && one.againstPlane == other.againstPlane;
}

bool isAwake(const Contact& contact, const RestingBodies& resting) {
  const auto isUp = [&](int body) { return body != kFixed && !resting.isResting(body); };
  return isUp(contact.bodyA) || isUp(contact.bodyB);
}

}  // namespace cradle

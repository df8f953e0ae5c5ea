#include "constraints/contact_groups.h"

#include <algorithm>
#include <set>
#include <utility>

#include "constraints/disjoint_sets.h"

namespace cradle {
namespace {

constexpr double kParallel = 1e-9;       // sine between normals of faces that lie on each other
constexpr std::size_t kMaxSharing = 12;  // contacts, of three boxes: more are dear to solve

}  // namespace

std::vector<ContactGroup> findContactGroups(const std::vector<ContactConstraint>& contacts,
                                            const Constraints& constraints, const std::vector<char>& fixed) {
  const auto moving = [&](int body) { return body == kFixed || fixed[static_cast<std::size_t>(body)] ? kFixed : body; };
  DisjointSets sets(fixed.size());
  for (const ContactConstraint& contact : contacts)
    sets.join(moving(contact.centerA.body), moving(contact.surfaceB.body));
  for (const Constraint& constraint : constraints)
    sets.join(moving(constraint.anchorA.body), moving(constraint.anchorB.body));

  std::vector<ContactGroup> groups;
  std::vector<int> groupOfSet(fixed.size(), -1);
  const auto groupOf = [&](int bodyA, int bodyB) -> int* {
    const int body = std::max(moving(bodyA), moving(bodyB));
    return body == kFixed ? nullptr : &groupOfSet[static_cast<std::size_t>(sets.islandOf(body))];
  };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    int* const group = groupOf(contacts[i].centerA.body, contacts[i].surfaceB.body);
    if (!group) continue;
    if (*group < 0) {
      *group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    groups[static_cast<std::size_t>(*group)].contacts.push_back(static_cast<int>(i));
  }
  for (const Constraint& constraint : constraints)
    if (const int* const group = groupOf(constraint.anchorA.body, constraint.anchorB.body); group && *group >= 0)
      groups[static_cast<std::size_t>(*group)].hasConstraints = true;
  for (int body = 0; body < static_cast<int>(fixed.size()); ++body)
    if (const int* const group = groupOf(body, kFixed); group && *group >= 0)
      groups[static_cast<std::size_t>(*group)].bodies.push_back(body);
  return groups;
}

bool joinWithoutLoop(const std::vector<std::pair<int, int>>& contacts, const std::vector<char>& fixed,
                     bool hasConstraints) {
  if (contacts.size() > kMaxSharing) return false;
  const auto moving = [&](int body) { return body == kFixed || fixed[static_cast<std::size_t>(body)] ? kFixed : body; };
  std::set<std::pair<int, int>> pairs;
  std::set<int> bodies;
  for (const auto& [a, b] : contacts) {
    pairs.emplace(std::minmax({a, b}));
    for (const int body : {moving(a), moving(b)})
      if (body != kFixed) bodies.insert(body);
  }
  return pairs.size() <= (hasConstraints ? std::size_t{1} : bodies.size());
}

bool areParallel(const Vec3& one, const Vec3& other) {
  return one.cross(other).norm() < kParallel;
}

}  // namespace cradle

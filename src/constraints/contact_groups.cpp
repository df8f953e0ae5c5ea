// Which rows ContactSolver solves together: bodies joined by contacts and constraints, found anew when the joining
// changes.

#include <algorithm>
#include <numeric>

#include "constraints/contact_forces.h"

namespace cradle {
namespace {

int rootOf(std::vector<int>& parents, int body) {
  while (parents[static_cast<std::size_t>(body)] != body) {
    int& parent = parents[static_cast<std::size_t>(body)];
    parent = parents[static_cast<std::size_t>(parent)];
    body = parent;
  }
  return body;
}

}  // namespace

bool ContactSolver::hasKnownStructure(const std::vector<char>& resting) const {
  // One contact less and one constraint more may join the same bodies.
  if (forces_.size() != contacts_.size() ||
      static_cast<std::size_t>(bilateralMultipliers_.size()) != bilateralRows_.size())
    return false;
  if (resting != resting_) return false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const ContactConstraint& contact = contacts_[i];
    if (!(joints_[i] == Joint{contact.centerA.body, contact.surfaceB.body, contact.motion})) return false;
  }
  for (std::size_t i = 0; i < bilateralRows_.size(); ++i) {
    const Joint& joint = joints_[contacts_.size() + i];
    if (joint.bodyA != bilateralRows_[i].bodyA || joint.bodyB != bilateralRows_[i].bodyB) return false;
  }
  return true;
}

/// kFixed for bodies at rest.
int ContactSolver::movingBody(int body) const {
  return body == kFixed || resting_[static_cast<std::size_t>(body)] ? kFixed : body;
}

void ContactSolver::analyze(const std::vector<char>& resting) {
  resting_ = resting;
  joints_.clear();
  for (const ContactConstraint& contact : contacts_)
    joints_.push_back({contact.centerA.body, contact.surfaceB.body, contact.motion});
  for (const ConstraintRow& row : bilateralRows_)
    joints_.push_back({row.bodyA, row.bodyB, ContactMotion::frictionless});
  numberGroups();
  sizeRows();
}

/// Groups in the order of their first contacts.
void ContactSolver::numberGroups() {
  std::vector<int> parents(bodies_.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const Joint& joint : joints_) {
    const int a = movingBody(joint.bodyA), b = movingBody(joint.bodyB);
    if (a != kFixed && b != kFixed) parents[static_cast<std::size_t>(rootOf(parents, a))] = rootOf(parents, b);
  }
  groups_.clear();
  std::vector<int> groupOfRoot(bodies_.size(), -1);
  const auto rootOfJoint = [&](const Joint& joint) {
    const int body = std::max(movingBody(joint.bodyA), movingBody(joint.bodyB));
    return body == kFixed ? -1 : rootOf(parents, body);
  };
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const int root = rootOfJoint(joints_[i]);
    if (root < 0) continue;
    const bool isContact = i < contacts_.size();
    int& group = groupOfRoot[static_cast<std::size_t>(root)];
    if (group < 0 && !isContact) continue;
    if (group < 0) {
      group = static_cast<int>(groups_.size());
      groups_.emplace_back();
    }
    Group& members = groups_[static_cast<std::size_t>(group)];
    (isContact ? members.contacts : members.bilateral)
        .push_back(static_cast<int>(isContact ? i : i - contacts_.size()));
  }
  groupOfBody_.assign(bodies_.size(), -1);
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const int group = groupOfRoot[static_cast<std::size_t>(rootOf(parents, static_cast<int>(body)))];
    groupOfBody_[body] = group;
    if (group >= 0) groups_[static_cast<std::size_t>(group)].bodies.push_back(static_cast<int>(body));
  }
}

void ContactSolver::sizeRows() {
  int rows = 0;
  for (Group& group : groups_) {
    group.firstRow = rows;
    group.positionRows = static_cast<int>(group.contacts.size() + group.bilateral.size());
    group.rows = group.positionRows;
    for (const int contact : group.contacts) {
      const ContactMotion motion = contacts_[static_cast<std::size_t>(contact)].motion;
      if (motion == ContactMotion::sticking) group.rows += 2;
      if (motion == ContactMotion::sliding) group.slides = true;
    }
    rows += group.rows;
    group.solver.resize(group.rows);
  }
  const std::size_t size = static_cast<std::size_t>(rows);
  rows_.resize(size);
  responses_.resize(size);
  coupled_.resize(size);
  multipliers_.resize(size);
  kinematics_.resize(contacts_.size());
  forces_.assign(contacts_.size(), {});
  bilateralMultipliers_.setZero(static_cast<Eigen::Index>(bilateralRows_.size()));
  std::vector<char> isGrouped(bodies_.size());
  for (std::size_t body = 0; body < bodies_.size(); ++body) isGrouped[body] = groupOfBody_[body] >= 0;
  constraintSolver_.exclude(isGrouped);
  hasFreeConstraints_ = std::any_of(bilateralRows_.begin(), bilateralRows_.end(), [this](const ConstraintRow& row) {
    return !constraintSolver_.isExcluded(row.bodyA, row.bodyB);
  });
}

}  // namespace cradle

#pragma once

#include <utility>
#include <vector>

#include "constraints/constraint.h"
#include "constraints/contact_rows.h"

namespace cradle {

/// Bodies that contacts and constraints join, at least one of them a contact. Indices ascend.
struct ContactGroup {
  std::vector<int> bodies, contacts;
  bool hasConstraints = false;
};

/// The groups of the bodies that are not `fixed`, in the order of their first contacts. Fixed bodies join nothing.
std::vector<ContactGroup> findContactGroups(const std::vector<ContactConstraint>& contacts,
                                            const Constraints& constraints, const std::vector<char>& fixed);

/// Whether a few contacts, by the bodies that each joins, do so without a loop; those `fixed` are one. Constraints of
/// these bodies may close loops: with them, contacts of one pair alone have none. Where all normals are parallel as
/// well, as in a stack, what each face carries in all follows from the loads, and its contacts share that.
bool joinWithoutLoop(const std::vector<std::pair<int, int>>& contacts, const std::vector<char>& fixed,
                     bool hasConstraints);

/// Whether two unit normals are those of faces that lie on each other.
bool areParallel(const Vec3& one, const Vec3& other);

}  // namespace cradle

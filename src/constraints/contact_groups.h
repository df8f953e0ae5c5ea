#pragma once

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

}  // namespace cradle

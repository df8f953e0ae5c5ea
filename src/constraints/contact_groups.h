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
/// these bodies may close loops: with them, contacts of one pair alone have none. Where the normals of each pair are
/// parallel as well (areOfFaces), what each face carries in all follows from the loads, and its contacts share that.
bool joinWithoutLoop(const std::vector<std::pair<int, int>>& contacts, const std::vector<char>& fixed,
                     bool hasConstraints);

/// Whether two unit normals are those of faces that lie on each other.
bool areParallel(const Vec3& one, const Vec3& other);

/// Whether each two bodies touch with one face: the normals of their contacts are parallel. `pairOf` and `normalOf`
/// give the two bodies (in any order, comparable) and the unit normal of each of `count` contacts.
template <typename PairOf, typename NormalOf>
bool areOfFaces(std::size_t count, PairOf pairOf, NormalOf normalOf) {
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (pairOf(j) == pairOf(i)) {  // the first of its pair stands for all
        if (!areParallel(normalOf(j), normalOf(i))) return false;
        break;
      }
  return true;
}

}  // namespace cradle

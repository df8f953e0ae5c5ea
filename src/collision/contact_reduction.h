#pragma once

#include <vector>

#include "collision/contact_point.h"

namespace cradle {

/// Leaves, of contacts with (nearly) the same normal, those that the others are between: the farthest in six directions
/// across the normal, and the deepest if it is deeper than those. They hold a body as well as all do: a corner of their
/// outline is lost only if it is blunter than 120 degrees. Those at one place become one,
/// with their mean normal. Looks at contacts from index `first` on, whose order decides between equal ones; `size` (m)
/// is that of the bodies. O(contacts x normals).
void reduceContacts(std::size_t first, double size, std::vector<ContactPoint>& contacts);

}  // namespace cradle

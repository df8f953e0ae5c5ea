#pragma once

#include <vector>

#include "collision/contact_point.h"

namespace cradle {

/// Reduces contacts with (nearly) the same normal to those that enclose the others: the farthest in six directions
/// across the normal, and the deepest one if it is deeper than these. They hold a body as well as all do: a corner of
/// their outline is lost only if it is blunter than 120 degrees. Contacts at one place become one, with their mean
/// normal. Contacts before index `first` stay as they are; the order of the others decides between equal ones; `size`
/// (m) is that of the bodies. O(contacts x normals).
void reduceContacts(std::size_t first, double size, std::vector<ContactPoint>& contacts);

}  // namespace cradle

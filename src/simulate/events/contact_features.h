#pragma once

#include <vector>

#include "collision/separation.h"

namespace cradle {

/// Tells which features of two convex shapes, not of a plane, touch at each contact: of two flat faces the corner of
/// either that it is; of edges and the sides of capsules and cylinders the straight lines (Contact::lineA, lineB) with
/// the radii around them, where one touches a sphere or two cross. Two that are parallel, one of them a side, touch at
/// both ends of what they share: the contact becomes two. Where features are none of these, as parallel edges, or a
/// rim, radii stay infinite or NaN, and the contact cannot last. A contact that is `leaving` (m) beyond the border of
/// a face, or the end of a line, has left it (EventTolerances::leaving).
void findFeatures(const ContactGeometry& geometry, const VectorX& state, double leaving,
                  std::vector<Contact>& contacts);

}  // namespace cradle

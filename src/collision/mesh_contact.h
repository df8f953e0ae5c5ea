#pragma once

#include "collision/contact_point.h"
#include "collision/feature_neighbour_list.h"

namespace cradle {

/// The contacts of two closed surfaces with separation <= margin (m), in A's frame: corners on faces and edges across
/// edges where neither solid reaches beyond the common tangent plane, so that inner edges of flat or hollow places give
/// none; and where none of these is as near as the surfaces are, the nearest points. Of many with one normal those that
/// hold as well as all. Overlaps deeper than 1/100 of the size give one contact, which leads out. Appends to
/// `contacts`. `near` is kept from call to call with these surfaces; it changes nothing but the cost.
void appendContacts(const MeshPair& pair, FeatureNeighbourList& near, double margin,
                    std::vector<ContactPoint>& contacts);

}  // namespace cradle

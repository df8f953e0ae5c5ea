#pragma once

#include "simulate/assembly.h"

namespace cradle {

/// Joints whose anchor is where their bodies touch something: tells colliders of the anchors
/// (Collider::pins), and adds to the constraints what such a contact forbids for ever. A surface that is round at the
/// anchor cannot roll on a flat one: with the anchor at height 0 its lowest point would sink by R (1 - cos angle), for
/// turns of either sense; nor on a round one, or along an edge. The contact has no moment arm about the anchor to
/// prevent that by a finite force, so it is a constraint: a round end on a face keeps its normal, the side or rim of a
/// cylinder its tangent in the face, what is round on an edge keeps its normal across the edge, and surfaces that share
/// a line stay along it. The colliders, joints and near pairs of `assembly` must be there.
void constrainPinnedContacts(Assembly& assembly);

}  // namespace cradle

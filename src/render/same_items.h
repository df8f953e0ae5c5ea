#pragma once

#include "render/draw_list.h"
#include "render/stage.h"

namespace cradle {

/// Whether OpenGL, which computes in single precision, draws two items alike; the balls near them apart.
bool isSame(const MeshItem& a, const MeshItem& b, const Stage& stage);
bool isSame(const SphereItem& a, const SphereItem& b, const Stage& stage);
bool isSame(const CylinderItem& a, const CylinderItem& b, const Stage& stage);
bool isSame(const TubeItem& a, const TubeItem& b, const Stage& stage);
bool isSame(const NeighbourItem& a, const NeighbourItem& b, const Stage& stage);

/// Needs a ground.
bool isSame(const ContactItem& a, const ContactItem& b, const Stage& stage);

}  // namespace cradle

#pragma once

#include <memory>
#include <string>
#include <vector>

#include "collision/collider.h"
#include "math/types.h"
#include "mesh/convex_hull.h"
#include "mesh/mass_properties.h"

namespace cradle {

/// A convex solid about its centre of mass.
struct PileHull {
  ConvexHull hull;                // m
  std::vector<Vec3> faceNormals;  // unit, outwards
  std::vector<Vec3> edges;        // unit, each once
  MassProperties massProperties;
};

/// A body of a heap: a hull, a box, or all points within `radius` of the segment from -halfSize to halfSize along y.
struct PileItem {
  std::shared_ptr<const PileHull> hull = {};
  double radius = 0;             // m; 0: a hull or a box
  Vec3 halfSize = Vec3::Zero();  // m; of a ball zero, of a capsule its half length in y, of a hull half of its bounds
  double mass = 1;               // kg
  Vec3 position = Vec3::Zero();  // m, of the centre
  Quat turn = Quat::Identity();  // worldFromBody
  Vec3 velocity = Vec3::Zero();  // m/s, at the start
  bool isBox() const { return radius == 0 && !hull; }
  double reach() const { return radius + halfSize.norm(); }  // m, from the centre
};

/// Bodies on a jittered grid over a tray of five planes, or that stand on a floor.
struct PileScene {
  double width = 2.4;  // m
  std::vector<PileItem> items;
  std::vector<PlaneCollider> planes;
};

/// The kinds of heaps that there are: "spheres", "boxes", "turned" (boxes), all of 0.2 m and 1 kg; of 1000 kg/m^3 and
/// turned "bars", "mixed" (balls and boxes of many sizes), "capsules" and "hulls" of 12 to 14 corners; "wall", bricks
/// of 1000 kg/m^3 in rows of ten that a ball of 263 kg strikes at 8 m/s; and "pyramid", boxes of 0.2 m and 1 kg in
/// rows.
const std::vector<std::string>& pileKinds();

/// `bodies`: of a pyramid those of its lowest row. `start` makes their places and turns others. Throws
/// std::invalid_argument for another kind.
PileScene makePileScene(int bodies, const std::string& kind, unsigned start = 1);

struct PilePoses {
  std::vector<Vec3> positions;  // m
  std::vector<Mat3> turns;      // worldFromBody
};

/// Depth (m) of the deepest overlap of two bodies or of a body and the tray, found from the poses alone.
double deepestOverlap(const PileScene& scene, const PilePoses& poses);

}  // namespace cradle

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/stability/rotation_drift.h"
#include "study/stability/smooth_motion_maps.h"

namespace cradle {
namespace {

constexpr double kAngle = 1e-3;  // rad, of one turn
constexpr int kMaxTurns = 1000000, kPointsADecade = 5;
constexpr double kMinTurnError = 1e-17, kMaxTurnError = 10;  // shown

struct Kept {
  const char* name;
  RotationStorage storage;
  Vec3 axis;
};

std::vector<Kept> allKept() {
  const Vec3 oblique = Vec3(1, 2, 3).normalized(), nearPitch = Vec3(0.002, 1, 0).normalized();
  return {{"Euler angles", RotationStorage::eulerAngles, oblique},
          {"Euler angles, past gimbal lock", RotationStorage::eulerAngles, nearPitch},
          {"matrix", RotationStorage::matrix, oblique},
          {"matrix, Gram-Schmidt", RotationStorage::orthogonalisedMatrix, oblique},
          {"quaternion", RotationStorage::quaternion, oblique},
          {"quaternion, normalised", RotationStorage::normalizedQuaternion, oblique}};
}

/// Errors of orientation and of shape after more and more turns; 0 is drawn at the lowest error shown.
struct Drift {
  MapCurve angle, shape;
};

Drift driftOf(const Kept& kept, bool isExact) {
  Drift drift{{kept.name, CurveKind::series, {}}, {kept.name, CurveKind::series, {}}};
  TurnedOrientation orientation(kept.storage, kAngle * kept.axis, isExact);
  double next = 1;
  for (int turns = 1; turns <= kMaxTurns; ++turns) {
    orientation.turn();
    if (turns < next && turns < kMaxTurns) continue;
    while (next <= turns) next *= std::pow(10, 1.0 / kPointsADecade);
    const double angle = orientation.angleError(), shape = orientation.shapeError();
    drift.angle.points.push_back({static_cast<double>(turns), std::max(angle, kMinTurnError)});
    if (kept.storage != RotationStorage::eulerAngles)
      drift.shape.points.push_back({static_cast<double>(turns), std::max(shape, kMinTurnError)});
  }
  return drift;
}

}  // namespace

StabilityMap rotationDriftMap(const MapProgress& progress) {
  StabilityMap map;
  map.name = "rotation_drift";
  map.title = "A million small rotations: what angles, matrices and quaternions make of them";
  map.subtitle = fmt::format(
      "Turns of {} rad about an axis of the world, against the closed form. Below: |R^T R - 1| and ||q|^2 - 1|; 0 is "
      "drawn at 1e-17",
      kAngle);
  map.paragraph =
      "Added up to first order (x += h x'), a matrix and a quaternion stop being rotations: after a million turns of "
      "0.001 rad the matrix is 65 % too large, the quaternion 13 %. Normalising keeps a quaternion's length and costs "
      "nothing: its angle is 8e-5 rad behind, the n a^3 / 12 of theory, four times less than the matrix. Gram-Schmidt "
      "keeps a matrix orthogonal and spoils the orientation: its first column is favoured at every turn, and the "
      "error, of second order in the angle, adds up to 0.2 rad. Euler angles are off by 0.03 rad, and jump where the "
      "motion passes gimbal lock: there, yaw and roll turn about the same axis, and their rates grow without bound. As "
      "products with exact rotations nothing is left but rounding. Cradle keeps normalised quaternions, and integrates "
      "them at the order of its method.";
  map.x = logarithmicAxis("rotations", "", {});
  map.y = logarithmicAxis("error", "rad, or no unit", {kMinTurnError, kMaxTurnError});
  map.panels = {{"orientation (rad), first order", {}, {}},
                {"orientation (rad), exact products", {}, {}},
                {"how far from a rotation, first order", {}, {}},
                {"how far from a rotation, exact products", {}, {}}};
  const std::vector<Kept> all = allKept();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const bool isExact : {false, true}) {
      if (isExact && all[i].storage == RotationStorage::eulerAngles) continue;
      const Drift drift = driftOf(all[i], isExact);
      map.panels[isExact ? 1 : 0].curves.push_back(drift.angle);
      if (!drift.shape.points.empty()) map.panels[isExact ? 3 : 2].curves.push_back(drift.shape);
    }
    progress(static_cast<double>(i + 1) / static_cast<double>(all.size()));
  }
  return map;
}

}  // namespace cradle

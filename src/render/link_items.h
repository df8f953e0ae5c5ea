#pragma once

#include <utility>

#include "render/draw_list.h"

namespace cradle {

/// What links are made of.
inline const Surface kSteel{Vec3f(0.56f, 0.57f, 0.58f), 1.0f, 0.28f};
inline const Surface kDarkSteel{Vec3f(0.16f, 0.165f, 0.175f), 0.6f, 0.45f};
inline const Surface kHemp{Vec3f(0.36f, 0.26f, 0.15f), 0.0f, 0.85f};

// Joints as they are drawn, in radii of a drawn rod.
inline constexpr double kBallJointOfRod = 4;                         // radius of a ball joint
inline constexpr double kPinOfRod = 2.5, kPinLengthOfRod = 12;       // radius, of an axle too; length of a hinge's pin
inline constexpr double kSleeveOfRod = 2.5, kSleeveLengthOfRod = 9;  // radius and length of what is on a slider's rail
inline constexpr double kRailLengthOfRod = 120;                      // longer if its sleeve is not on it
inline constexpr double kStopOfRod = 3.5, kStopLengthOfRod = 1.5;    // radius and length of a stop at the rail's end
inline constexpr double kBeadOfRod = 2.5;                            // radius of a weld

/// Where along a slider's axis its rail begins and ends, from anchor B, m: at its limits, with room for the sleeve; on
/// a side without one kRailLengthOfRod / 2 away; and as far as the sleeve goes, from `least` to `most`. `radius` is
/// that of a drawn rod.
std::pair<double, double> railEnds(const Slider& slider, double least, double most, double radius);

/// Appends what is seen of springs, rods, ropes and joints: coils, thin cylinders, small spheres at their ends, and
/// mounts where they hang from the world.
void appendLinks(const Scene& scene, const Appearance& appearance, const View& view,
                 const std::vector<RigidTransform>& worldFromBody, DrawList& list);

}  // namespace cradle

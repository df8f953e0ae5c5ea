#pragma once

#include <optional>

#include "math/types.h"

namespace cradle {

/// The curve on which the direction m of a freely turning body's angular momentum moves in the body: with axes numbered
/// so that the curve goes round axis 3 and axis 2 has the middle moment,
///   m = (amplitude_1 cn u, amplitude_2 sn u, amplitude_3 dn u), u = argument + rate * time.
struct Polhode {
  Quat bodyFromAxes;
  Vec3 inverseMoments;  // 1/(kg m^2), by axis
  Vec3 start;           // m at time 0; its components 1 and 3 are >= 0
  Vec3 amplitude;       // the second one has the sign of `sense`
  double sense;         // 1 if axis 3 has the largest moment, -1 if the smallest
  double modulus;       // k
  double complement;    // k' = sqrt(1 - k^2), not below 1e-145
  double rate;          // 1/s
  double argument;      // within a quarter period of 0
  double momentum;      // N m s, length of the angular momentum
};

/// Empty if the direction stays where it is: no rotation, rotation about a principal axis, all moments equal. Angular
/// momentum in the body's frame, N m s.
std::optional<Polhode> polhodeOf(const Mat3& inertiaTensor, const Vec3& angularMomentum);

}  // namespace cradle

#pragma once

#include "collision/separation.h"

namespace cradle {

constexpr const char* kTips = "a cylinder tips over its rim";
constexpr double kFlatRim = 1e-3;  // sine of a disc's tilt: flatter, its lowest point runs too fast around its rim

/// A tilted cylinder on a plane, or on a face of a convex shape, touches by the lowest point of a disc, which rolls
/// along its rim: moves the contact there. Other contacts stay as they are.
void moveToRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact);

/// The same for one that lies or stands, if it does not stand flat: it may tilt then. False if it does, or is no
/// cylinder on a plane.
bool rollOnRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact);

/// Whether both contacts are the lowest point of one rim: as places, for the gaps that they were found with may differ.
bool isSameRim(const Contact& one, const Contact& other);

/// Whether a cylinder touches by points of its rims or its side that stay the same as long as it stands or lies.
bool standsOnRim(const ContactGeometry& geometry, const Contact& contact);

/// Whether a cylinder touches by points of the rim of an end that is flat on the other surface.
bool standsOnEnd(const ContactGeometry& geometry, const Contact& contact);

/// m/s, at its rim: how fast the cylinder of a contact rotates out of the position in which it stands or lies.
double tippingSpeed(const ContactGeometry& geometry, const VectorX& state, const Contact& contact);

}  // namespace cradle

#pragma once

namespace cradle {

// Elementary functions that give the same bits on every CPU, by every compiler, at every optimisation level: those of
// the C library do not. Errors are below 1 unit in the last place for all finite arguments. Special values are those of
// IEEE 754: sin and cos of an infinity are NaN, exp(-inf) = 0, log(0) = -inf, log of a negative number is NaN.

double sin(double angle);  // rad, of any size
double cos(double angle);

struct SinCos {
  double sin, cos;
};
/// Both for little more than the price of one, with the same bits.
SinCos sinCos(double angle);

/// The angle (rad, -pi..pi) of a direction: sin and cos times a common positive number. Errors are below 4 units in the
/// last place. 0 of two zeros.
double atan2(double sin, double cos);

double exp(double x);
double log(double x);

}  // namespace cradle

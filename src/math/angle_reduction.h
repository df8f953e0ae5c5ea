#pragma once

namespace cradle {

/// An angle as `quarterTurns` * pi/2 + `remainder` + `tail`, up to whole turns.
struct ReducedAngle {
  int quarterTurns;  // 0 to 3
  double remainder;  // rad, within pi/4 of 0
  double tail;       // rad, what `remainder` lost to rounding
};

/// Takes the whole quarter turns out of any finite angle (rad), exactly: the relative error of remainder + tail is
/// below 2^-64 even for the double that comes closest to a multiple of pi/2.
ReducedAngle reduceAngle(double angle);

}  // namespace cradle

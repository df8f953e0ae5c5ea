#pragma once

namespace cradle {

// By how much numbers may be off that are stored in single precision (6e-8 each).
constexpr double kSingleRatio = 1.2e-7;   // of one; doubled, for the way there in double precision
constexpr double kSingleNormal = 1.8e-7;  // of a unit vector: three components, and their rounding on the way

}  // namespace cradle

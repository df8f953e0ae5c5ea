#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

namespace cradle {

/// Numbers that are allowed.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool excludesEnds = false;
  bool wantsInteger = false;

  bool holds(double number) const {
    if (wantsInteger && std::floor(number) != number) return false;
    if (excludesEnds) return number > least && number < most;
    return number >= least && number <= most;
  }
};
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr Range kAnyNumber{};
constexpr Range kFraction{0, 1};
constexpr std::size_t kMaxLights = 100;  // every OpenGL 3.3 has room for them: 1024 numbers in all (specification, 6.2)

// Ranges of a scene's quantities. Formulas multiply up to four masses or principal moments, or two moments and the
// squares of two velocities: with these, no product of theirs leaves the range of doubles, 1e-308 to 1e308. Where
// nature sets a limit, or the 16 digits of a double do, the range ends there.
constexpr Range kLengths{1e-9, 1e9};          // m: from an atom's radius to a star's
constexpr Range kLengthsOrZero{0, 1e9};       // m
constexpr Range kCoordinates{-1e12, 1e12};    // m: a double holds 0.1 mm there
constexpr Range kMasses{1e-36, 1e36};         // kg: an electron has 1e-30, a star 1e30
constexpr Range kDensities{1e-24, 1e24};      // kg/m^3: empty space has 1e-21, a neutron star 1e18
constexpr Range kMoments{1e-54, 1e54};        // kg m^2: the smallest and largest mass, at such a length
constexpr Range kMomentEntries{-1e54, 1e54};  // kg m^2
constexpr Range kSpeeds{-1e9, 1e9};           // m/s: light has 3e8, and Newton's mechanics end before
constexpr Range kAngularSpeeds{-1e9, 1e9};    // rad/s: steps of the shortest length follow no faster turns
constexpr Range kAccelerations{-1e12, 1e12};  // m/s^2: a neutron star's
constexpr Range kForces{-1e30, 1e30};         // N
constexpr Range kStiffnesses{0, 1e30};        // N/m
constexpr Range kDampings{0, 1e30};           // N s/m
constexpr Range kFrictions{0, 1e9};           // -: the cone is then as good as a half-space
constexpr Range kDurations{1e-9, 1e9};        // s: a thousand times what tells two instants apart, to 30 years
constexpr Range kPushDurations{1e-12, 1e9};   // s: what tells two instants apart
constexpr Range kTimeSteps{1e-12, 1e9};       // s: the same
constexpr Range kInstants{0, 1e9};            // s
constexpr Range kKeyTimes{-1e9, 1e9};         // s
constexpr Range kPeriods{-1e9, 1e9};          // s, of an orbit
constexpr Range kRates{1e-9, 1e9};            // 1/s of frames, and of film to simulated time
constexpr Range kScales{1e-18, 1e18};         // of a mesh: the largest length from the smallest
constexpr Range kAngles{-1e9, 1e9};           // degrees: a double holds 1e-7 of one there
constexpr Range kTurns{-1e9, 1e9};            // rad, of a hinge
constexpr Range kIntensities{0, 1e6};         // of light: pictures are white from 1e3 on

constexpr int kLargestPicture = 16384;  // pixels, of width and height; Mesa's limit

}  // namespace cradle

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace cradle {

/// The place of the number of which the seed of a scene's bumps is a function, if its file names none.
inline constexpr const char* kBumpSeedPlace = "/bumps/seed";

constexpr double kBumpSeeds = 0x1p52;  // as many as numbers that are uniform

/// From that impact of a body on, its bumps are of another seed, as `changes` of a scene's `bumps` say.
struct NamedBumpChange {
  std::string body;
  int impact = 1;
  std::uint64_t seed = 0;  // below 2^52
  bool operator==(const NamedBumpChange&) const = default;
};

/// How many impacts with bumps each body of a motion has, by name; none for those that have none.
using ImpactCounts = std::map<std::string, int>;

}  // namespace cradle

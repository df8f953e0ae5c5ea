#include "commands/shard.h"

#include <fmt/format.h>

#include "commands/number_pair.h"
#include "core/error.h"

namespace cradle {

Shard parseShard(const std::string& text) {
  constexpr long kMaxParts = 1'000'000;  // of frames or samples, which are as many at most
  const auto shard = parsePair(text, '/');
  if (!shard || shard->first < 1 || shard->first > shard->second || shard->second > kMaxParts)
    throw Error(ErrorKind::usage, "--shard",
                fmt::format("found \"{}\"; allowed is PART/PARTS with 1 <= PART <= PARTS, as 2/8", text));
  return {shard->first, shard->second};
}

}  // namespace cradle

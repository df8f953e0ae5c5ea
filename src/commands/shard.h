#pragma once

#include <string>

namespace cradle {

/// One of several parts of a number of things that are as many as each other, but for one.
struct Shard {
  long part = 1, parts = 1;  // part 1..parts

  long begin(long count) const { return (part - 1) * count / parts; }
  long end(long count) const { return part * count / parts; }
};

/// Of "PART/PARTS". Throws Error(usage) in the name of --shard.
Shard parseShard(const std::string& text);

}  // namespace cradle

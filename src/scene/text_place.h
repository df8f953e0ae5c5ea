#pragma once

#include <cstdint>

namespace cradle {

/// A place in a text as editors count: lines and characters from 1.
struct TextPlace {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
};

}  // namespace cradle

#pragma once

#include <string>

namespace cradle {

/// A text as one field of a table of comma-separated values: in quotes where it has to be.
std::string csvField(const std::string& text);

}  // namespace cradle

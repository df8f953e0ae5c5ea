#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cradle {

/// The numbers of a layer of an OpenEXR file, so many a pixel, row by row from above: channels LAYER.V of one, else
/// LAYER.X, LAYER.Y, LAYER.Z; of floats, or of whole numbers that Number holds. Nothing if the file has no such layer.
/// Throws Error(usage) if the file is missing, damaged or of another size (pixels), or has a part of the layer alone.
template <class Number>
std::optional<std::vector<Number>> readExr(const std::string& path, const std::string& layer, std::size_t channels,
                                           std::size_t width, std::size_t height);

}  // namespace cradle

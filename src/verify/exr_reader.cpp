#include "verify/exr_reader.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>

#include <exception>
#include <limits>
#include <type_traits>

#include "core/error.h"

namespace cradle {
namespace {

[[noreturn]] void refuseExr(const std::string& path, const std::string& found) {
  throw Error(ErrorKind::usage, path, found + "; draw it again with `cradle render --overwrite`");
}

std::string channelName(const std::string& layer, std::size_t channels, std::size_t channel) {
  return layer + "." + (channels == 1 ? "V" : std::string(1, "XYZ"[channel]));
}

/// Numbers as the file has them: floats, or 32-bit whole ones.
template <class Stored>
std::optional<std::vector<Stored>> readLayer(const std::string& path, const std::string& layer, std::size_t channels,
                                             std::size_t width, std::size_t height) {
  Imf::InputFile file(path.c_str(), 0);  // without threads of its own
  const Imath::Box2i window = file.header().dataWindow();
  if (window.min != Imath::V2i(0, 0) ||
      window.max != Imath::V2i(static_cast<int>(width) - 1, static_cast<int>(height) - 1))
    refuseExr(path, fmt::format("is not of {}x{} pixels", width, height));
  constexpr Imf::PixelType kType = std::is_same_v<Stored, float> ? Imf::FLOAT : Imf::UINT;
  std::vector<Stored> numbers(channels * width * height);
  Imf::FrameBuffer buffer;
  std::size_t found = 0;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const std::string name = channelName(layer, channels, channel);
    const Imf::Channel* known = file.header().channels().findChannel(name);
    if (known == nullptr) continue;
    if (known->type != kType) refuseExr(path, fmt::format("has other numbers than it should in channel {}", name));
    ++found;
    const std::size_t stride = channels * sizeof(Stored);
    buffer.insert(name, Imf::Slice(kType, reinterpret_cast<char*>(numbers.data() + channel), stride, stride * width));
  }
  if (found == 0) return std::nullopt;
  if (found < channels) refuseExr(path, fmt::format("has {} of {} channels of {}", found, channels, layer));
  file.setFrameBuffer(buffer);
  file.readPixels(0, static_cast<int>(height) - 1);
  return numbers;
}

}  // namespace

template <class Number>
std::optional<std::vector<Number>> readExr(const std::string& path, const std::string& layer, std::size_t channels,
                                           std::size_t width, std::size_t height) {
  using Stored = std::conditional_t<std::is_same_v<Number, float>, float, std::uint32_t>;
  std::optional<std::vector<Stored>> stored;
  try {
    stored = readLayer<Stored>(path, layer, channels, width, height);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    refuseExr(path, "is damaged, or no OpenEXR file");
  }
  if constexpr (std::is_same_v<Number, float>) {
    return stored;
  } else {
    if (!stored) return std::nullopt;
    std::vector<Number> numbers;
    for (const std::uint32_t number : *stored) {
      if (number > std::numeric_limits<Number>::max())
        refuseExr(path, fmt::format("has {} in layer {}, which is more than that holds", number, layer));
      numbers.push_back(static_cast<Number>(number));
    }
    return numbers;
  }
}

template std::optional<std::vector<float>> readExr(const std::string&, const std::string&, std::size_t, std::size_t,
                                                   std::size_t);
template std::optional<std::vector<std::uint16_t>> readExr(const std::string&, const std::string&, std::size_t,
                                                           std::size_t, std::size_t);
template std::optional<std::vector<std::uint8_t>> readExr(const std::string&, const std::string&, std::size_t,
                                                          std::size_t, std::size_t);

}  // namespace cradle

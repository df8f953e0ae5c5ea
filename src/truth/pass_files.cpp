#include "truth/pass_files.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "core/error.h"

namespace cradle {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kAlignment = 64;  // of the numbers, from the start of a NumPy file

/// NumPy's names of types.
const char* typeOf(const std::vector<float>&) {
  return "<f4";
}
const char* typeOf(const std::vector<std::uint16_t>&) {
  return "<u2";
}
const char* typeOf(const std::vector<std::uint8_t>&) {
  return "|u1";
}

template <class Number>
std::string npyBytes(const std::vector<Number>& numbers, const std::string& shape) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", typeOf(numbers), shape);
  const std::size_t before = 10;  // magic, version, length of the header
  header.append(kAlignment - 1 - (before + header.size()) % kAlignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  return bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
}

/// A file in memory, for OpenEXR.
class MemoryFile : public Imf::OStream {
 public:
  MemoryFile() : OStream("pass") {}

  void write(const char bytes[], int count) override {
    const std::size_t length = static_cast<std::size_t>(count);
    if (bytes_.size() < place_ + length) bytes_.resize(place_ + length);
    std::memcpy(&bytes_[place_], bytes, length);
    place_ += length;
  }
  uint64_t tellp() override { return place_; }
  void seekp(uint64_t place) override { place_ = place; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t place_ = 0;
};

std::string channelName(const PassArray& pass, int channel) {
  constexpr const char* kNames[] = {"X", "Y", "Z"};
  return pass.name + "." + (pass.channels == 1 ? "V" : kNames[channel]);
}

}  // namespace

std::string npyBytes(const PassArray& pass, int width, int height) {
  const std::string size = fmt::format("{}, {}", height, width);
  const std::string shape = pass.channels == 1 ? size : fmt::format("{}, {}", size, pass.channels);
  return std::visit([&](const auto& numbers) { return npyBytes(numbers, shape); }, pass.numbers);
}

std::string exrBytes(const std::vector<PassArray>& passes, int width, int height) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<std::uint32_t>> wholeNumbers(passes.size());  // kept until the file is written
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const PassArray& pass = passes[i];
    const auto* floats = std::get_if<std::vector<float>>(&pass.numbers);
    if (floats == nullptr)
      std::visit([&](const auto& numbers) { wholeNumbers[i].assign(numbers.begin(), numbers.end()); }, pass.numbers);
    const void* first = floats != nullptr ? static_cast<const void*>(floats->data()) : wholeNumbers[i].data();
    const Imf::PixelType type = floats != nullptr ? Imf::FLOAT : Imf::UINT;
    const std::size_t stride = 4 * static_cast<std::size_t>(pass.channels);
    for (int channel = 0; channel < pass.channels; ++channel) {
      // OpenEXR only reads what it writes.
      char* base = const_cast<char*>(static_cast<const char*>(first)) + 4 * channel;
      header.channels().insert(channelName(pass, channel), Imf::Channel(type));
      buffer.insert(channelName(pass, channel),
                    Imf::Slice(type, base, stride, stride * static_cast<std::size_t>(width)));
    }
  }
  MemoryFile file;
  {
    Imf::OutputFile output(file, header, 0);  // without threads of its own
    output.setFrameBuffer(buffer);
    output.writePixels(height);
  }
  return file.take();
}

}  // namespace cradle

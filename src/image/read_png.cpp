// The only unit that sees libpng, which holds each part of a file against its checksum. (stb_image, which has no
// dependency, checks none, and takes three times the memory of a picture.)

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "core/error.h"
#include "core/read_file.h"
#include "image/png.h"

namespace cradle {
namespace {

constexpr int kMaxPixels = 16384;            // a side
constexpr long kMaxInterlaced = 64'000'000;  // pixels, of a picture that is compared
constexpr png_uint_32 kAnySize = PNG_UINT_31_MAX;
// Bytes that one byte of a file becomes at most: a match of 258 bytes takes two bits or more (RFC 1951, 3.2.5).
constexpr std::uint64_t kMaxDeflation = 1032;

}  // namespace

/// A file that is being read. libpng tells of a fault by a jump: no function between that and its target has an object
/// with a destructor.
class PngReading {
 public:
  explicit PngReading(const std::string& path) : path_(path) {
    requireRegularFile(path, ErrorKind::usage);
    file_.reset(std::fopen(path.c_str(), "rb"));
    if (!file_) throw Error(ErrorKind::usage, path, std::string("cannot be opened: ") + std::strerror(errno));
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, noteFault, [](png_structp, png_const_charp) {});
    info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw std::bad_alloc();
    }
  }
  ~PngReading() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReading(const PngReading&) = delete;
  PngReading& operator=(const PngReading&) = delete;

  /// All up to the rows. Returns the size in pixels.
  PictureSize readHeader() {
    step([this] {
      png_set_read_fn(png_, this, readBytes);
      png_set_user_limits(png_, kAnySize, kAnySize);  // told below, in words
      png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
      png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr,
                                  -1);  // of texts and profiles, only the checksums
      png_set_benign_errors(png_, 0);
      png_read_info(png_, info_);
    });
    const png_uint_32 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    if (width > kMaxPixels || height > kMaxPixels)
      throw Error(ErrorKind::usage, path_,
                  fmt::format("is {}x{} pixels; allowed are 1..{} a side", width, height, kMaxPixels));
    return {static_cast<int>(width), static_cast<int>(height)};
  }

  /// Throws if the file is too short for the rows that its header names, before there is memory for them, or is cut
  /// off.
  void requireRows() {
    requireEnd();
    const std::uint64_t rowBytes = png_get_rowbytes(png_, info_), height = png_get_image_height(png_, info_);
    std::error_code failed;
    const std::uint64_t size = std::filesystem::file_size(path_, failed);
    if (!failed && size * kMaxDeflation < rowBytes * height)
      throw Error(ErrorKind::usage, path_,
                  fmt::format("is not a picture that can be read: it has {} bytes, too few for {} rows of {}", size,
                              height, rowBytes));
  }

  bool isInterlaced() const { return png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE; }

  /// Rows are wanted from here on, as red, green and blue.
  void beginRows() {
    step([this] {
      png_set_strip_16(png_);
      png_set_expand_gray_1_2_4_to_8(png_);
      png_set_palette_to_rgb(png_);
      png_set_gray_to_rgb(png_);
      png_set_strip_alpha(png_);
      png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
    });
  }

  /// The next row of a picture that is not interlaced.
  void readRow(std::uint8_t* row) {
    step([this, row] { png_read_row(png_, row, nullptr); });
  }

  void readRows(Image& image) {
    std::vector<png_bytep> rows;
    for (int y = 0; y < image.height; ++y) rows.push_back(image.at(0, y));
    step([this, &rows] { png_read_image(png_, rows.data()); });
  }

  /// What is behind the rows.
  void readEnd() {
    step([this] { png_read_end(png_, nullptr); });
  }

 private:
  /// Throws if chunks go beyond the end of the file: else the rows before would be unpacked first. (Portable Network
  /// Graphics, third edition, section 5: signature of 8 bytes, then chunks of length, type, data and checksum)
  void requireEnd() {
    const long place = std::ftell(file_.get());
    std::array<unsigned char, 8> head{};
    std::array<unsigned char, 4096> skipped{};  // short chunks are read on: each fseek is a call of the system
    std::error_code failed;
    const std::uint64_t size = std::filesystem::file_size(path_, failed);
    std::fseek(file_.get(), 8, SEEK_SET);
    for (std::uint64_t at = 8; !failed;) {
      if (at + 12 > size) throw Error(ErrorKind::usage, path_, "is not a picture that can be read: it ends too early");
      if (std::fread(head.data(), 1, head.size(), file_.get()) != head.size()) break;
      const std::uint64_t length =
          std::uint64_t{head[0]} << 24 | std::uint64_t{head[1]} << 16 | std::uint64_t{head[2]} << 8 | head[3];
      at += 12 + length;
      if (at > size) throw Error(ErrorKind::usage, path_, "is not a picture that can be read: it ends too early");
      if (std::memcmp(head.data() + 4, "IEND", 4) == 0) break;
      const std::uint64_t rest = length + 4;
      if (rest > skipped.size())
        std::fseek(file_.get(), static_cast<long>(at), SEEK_SET);
      else if (std::fread(skipped.data(), 1, rest, file_.get()) != rest)
        break;
    }
    std::fseek(file_.get(), place, SEEK_SET);
  }

  template <class Step>
  void step(Step calls) {
    if (setjmp(png_jmpbuf(png_)) == 0)
      calls();
    else
      throw Error(ErrorKind::usage, path_, fmt::format("is not a picture that can be read: {}", fault_));
  }

  [[noreturn]] static void noteFault(png_structp png, png_const_charp fault) {
    char* kept = static_cast<PngReading*>(png_get_error_ptr(png))->fault_;
    std::strncpy(kept, fault, sizeof(fault_) - 1);
    png_longjmp(png, 1);
  }

  static void readBytes(png_structp png, png_bytep bytes, std::size_t count) {
    std::FILE* file = static_cast<PngReading*>(png_get_io_ptr(png))->file_.get();
    if (std::fread(bytes, 1, count, file) != count) png_error(png, "it ends too early");
  }

  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, std::fclose};
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  char fault_[120] = "";
};

PictureSize readPngSize(const std::string& path) {
  PngReading reading(path);
  const PictureSize size = reading.readHeader();
  reading.requireRows();
  return size;
}

Image readPng(const std::string& path) {
  PngReading reading(path);
  const PictureSize size = reading.readHeader();
  reading.requireRows();
  reading.beginRows();
  Image image(size.width, size.height);
  reading.readRows(image);
  reading.readEnd();
  return image;
}

PngRows::PngRows(const std::string& path) : reading_(std::make_unique<PngReading>(path)) {
  size_ = reading_->readHeader();
  reading_->requireRows();
  if (!reading_->isInterlaced()) return;
  if (const long pixels = long{size_.width} * size_.height; pixels > kMaxInterlaced)
    throw Error(
        ErrorKind::usage, path,
        fmt::format("is interlaced, and has {} pixels; at most {} are allowed then; save it without interlacing",
                    pixels, kMaxInterlaced));
}

PngRows::~PngRows() = default;

const std::uint8_t* PngRows::next() {
  CRADLE_CHECK(count_ < size_.height);
  if (count_ == 0) {
    reading_->beginRows();
    row_.resize(3 * static_cast<std::size_t>(size_.width));
    if (reading_->isInterlaced()) {
      interlaced_ = Image(size_.width, size_.height);
      reading_->readRows(interlaced_);
    }
  }
  if (!reading_->isInterlaced()) reading_->readRow(row_.data());
  const int y = count_++;
  if (count_ == size_.height) reading_->readEnd();
  return reading_->isInterlaced() ? interlaced_.at(0, y) : row_.data();
}

}  // namespace cradle

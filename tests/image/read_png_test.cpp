#include <gtest/gtest.h>
#include <libdeflate.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "core/error.h"
#include "image/png.h"
#include "image/temporary_folder.h"
#include "image/test_pictures.h"

// The format: PNG specification (W3C, third edition), sections 5 and 11.

namespace cradle {
namespace {

constexpr char kGrey = 0, kRgb = 2, kPalette = 3, kRgbAlpha = 6;  // colour types

std::string bigEndian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift);
  return bytes;
}

std::string chunk(const std::string& nameAndData) {
  const std::uint32_t checksum = libdeflate_crc32(0, nameAndData.data(), nameAndData.size());
  return bigEndian(static_cast<std::uint32_t>(nameAndData.size() - 4)) + nameAndData + bigEndian(checksum);
}

/// A zlib stream of one block that is not compressed (RFC 1950 and 1951).
std::string stored(const std::string& bytes) {
  const auto size = static_cast<std::uint16_t>(bytes.size());
  std::string stream = {'\x78', '\x01', '\x01'};
  for (const int part : {size & 0xff, size >> 8, ~size & 0xff, (~size >> 8) & 0xff}) stream += static_cast<char>(part);
  return stream + bytes + bigEndian(libdeflate_adler32(1, bytes.data(), bytes.size()));
}

const std::string kSignature = "\x89PNG\r\n\x1a\n";

std::string header(std::uint32_t width, std::uint32_t height, char depth, char colourType, char isInterlaced = 0) {
  return chunk("IHDR" + bigEndian(width) + bigEndian(height) + std::string{depth, colourType, 0, 0, isInterlaced});
}

/// `rows` with the number of its filter before each.
std::string pngFile(const std::string& head, const std::string& rows, const std::string& more = "") {
  return kSignature + head + more + chunk("IDAT" + stored(rows)) + chunk("IEND");
}

class ReadPng : public ::testing::Test {
 protected:
  Image read(const std::string& bytes) const {
    std::ofstream(folder_ / "a.png", std::ios::binary) << bytes;
    return readPng(folder_ / "a.png");
  }

  /// What is said of it, or "accepted".
  std::string refusal(const std::string& bytes) const {
    try {
      read(bytes);
      return "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
  }

  static std::vector<int> pixel(const Image& image, int x, int y) {
    return {image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]};
  }

  TemporaryFolder folder_;
};

TEST_F(ReadPng, AllKindsBecomeRgbOfEightBits) {
  using Colour = std::vector<int>;
  const std::string none(1, '\0');                                                       // no filter
  const Image grey = read(pngFile(header(2, 1, 16, kGrey), none + "\x12\xff\xab\x01"));  // the low byte goes
  EXPECT_EQ(pixel(grey, 0, 0), Colour({0x12, 0x12, 0x12}));
  EXPECT_EQ(pixel(grey, 1, 0), Colour({0xab, 0xab, 0xab}));
  const Image bits = read(pngFile(header(2, 1, 1, kGrey), none + "\x40"));
  EXPECT_EQ(pixel(bits, 0, 0), Colour({0, 0, 0}));
  EXPECT_EQ(pixel(bits, 1, 0), Colour({255, 255, 255}));
  const std::string colours = chunk("PLTE\x01\x02\x03\xfd\xfe\xff") + chunk(std::string("tRNS\0", 5));
  const Image palette = read(pngFile(header(2, 1, 8, kPalette), none + std::string("\x01\0", 2), colours));
  EXPECT_EQ(pixel(palette, 0, 0), Colour({0xfd, 0xfe, 0xff}));
  EXPECT_EQ(pixel(palette, 1, 0), Colour({1, 2, 3}));
  const Image alpha = read(pngFile(header(1, 1, 8, kRgbAlpha), none + std::string("\x0a\x0b\x0c\0", 4)));
  EXPECT_EQ(pixel(alpha, 0, 0), Colour({10, 11, 12}));
}

TEST_F(ReadPng, GammaAndProfilesChangeNoPixel) {
  const std::string gamma = chunk("gAMA" + bigEndian(22000)) + chunk(std::string("iCCPx\0\0nonsense", 15));
  const Image image = read(pngFile(header(1, 1, 8, kRgb), std::string("\0\x40\x80\xc0", 4), gamma));
  EXPECT_EQ(pixel(image, 0, 0), std::vector<int>({0x40, 0x80, 0xc0}));
}

TEST_F(ReadPng, EveryFlippedBitIsSeen) {
  const std::string good = pngFile(header(2, 2, 8, kRgb), std::string("\0abcdef\0ghijkl", 14), chunk("tEXtAuthor"));
  ASSERT_EQ(refusal(good), "accepted");
  for (std::size_t byte = 0; byte < good.size(); ++byte)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = good;
      damaged[byte] = static_cast<char>(damaged[byte] ^ 1 << bit);
      ASSERT_NE(refusal(damaged), "accepted") << "bit " << bit << " of byte " << byte;
    }
}

TEST_F(ReadPng, ChecksumOfTheRowsIsHeldAgainstThem) {
  // The row's last byte differs, and the chunk's own checksum is right.
  std::string rows = stored(std::string("\0abc", 4));
  rows[rows.size() - 5] = 'x';
  const std::string file = kSignature + header(1, 1, 8, kRgb) + chunk("IDAT" + rows) + chunk("IEND");
  EXPECT_NE(refusal(file).find("IDAT"), std::string::npos) << refusal(file);
}

TEST_F(ReadPng, CutAnywhereIsRefused) {
  const std::string good = pngFile(header(2, 2, 8, kRgb), std::string("\0abcdef\0ghijkl", 14));
  for (std::size_t size = 0; size < good.size(); ++size) ASSERT_NE(refusal(good.substr(0, size)), "accepted") << size;
}

TEST_F(ReadPng, LargestSideIsNamed) {
  const std::string file = pngFile(header(16385, 1, 8, kRgb), "");
  EXPECT_NE(refusal(file).find("16385x1 pixels; allowed are 1..16384"), std::string::npos) << refusal(file);
  EXPECT_NE(refusal(pngFile(header(0, 1, 8, kRgb), "")), "accepted");
}

TEST_F(ReadPng, PipeIsRefusedAtOnce) {
  ASSERT_EQ(mkfifo((folder_ / "pipe.png").c_str(), 0600), 0);
  EXPECT_THROW(readPng(folder_ / "pipe.png"), Error);
}

TEST_F(ReadPng, SizeNeedsNoRows) {
  const std::string begin = kSignature + header(7, 3, 8, kRgb) + bigEndian(1000) + "IDAT";
  std::ofstream(folder_ / "a.png", std::ios::binary)
      << begin + std::string(1000 + 4, 'x') + bigEndian(0) + "IEND" + bigEndian(0);
  EXPECT_EQ(readPngSize(folder_ / "a.png"), (PictureSize{7, 3}));
  EXPECT_THROW(readPng(folder_ / "a.png"), Error);
  std::ofstream(folder_ / "a.png", std::ios::binary) << begin + std::string(900, 'x');  // cut off
  EXPECT_THROW(readPngSize(folder_ / "a.png"), Error);
}

TEST_F(ReadPng, RowsOneByOneAreThoseOfThePicture) {
  const std::string none(1, '\0');
  // Interlaced: the passes 1, 6 and 7 of 2 x 2 pixels.
  for (const std::string& file : {pngFile(header(2, 2, 8, kRgb), none + "abcdef" + none + "ghijkl"),
                                  pngFile(header(2, 2, 8, kRgb, 1), none + "abc" + none + "def" + none + "ghijkl"),
                                  pngFile(header(2, 2, 1, kGrey), none + "\x40" + none + "\x80")}) {
    const Image whole = read(file);
    PngRows rows(folder_ / "a.png");
    EXPECT_EQ(rows.size(), (PictureSize{2, 2}));
    for (int y = 0; y < 2; ++y) {
      const std::uint8_t* row = rows.next();
      EXPECT_TRUE(std::equal(row, row + 6, whole.at(0, y)));
    }
  }
}

TEST_F(ReadPng, RowsOneByOneShowWhatIsDamagedBehindThem) {
  std::string file = pngFile(header(1, 1, 8, kRgb), std::string("\0abc", 4));
  file[file.size() - 1] ^= 1;  // the checksum of the end
  std::ofstream(folder_ / "a.png", std::ios::binary) << file;
  PngRows rows(folder_ / "a.png");
  EXPECT_THROW(rows.next(), Error);
}

TEST_F(ReadPng, LargeInterlacedPicturesAreNotReadByRows) {
  const std::string rows(100'000, 'x');  // a byte may become 1032 rows' bytes
  std::ofstream(folder_ / "a.png", std::ios::binary)
      << kSignature + header(16384, 4096, 8, kGrey, 1) + chunk("IDAT" + rows) + chunk("IEND");
  EXPECT_EQ(readPngSize(folder_ / "a.png"), (PictureSize{16384, 4096}));
  EXPECT_THROW(PngRows(folder_ / "a.png"), Error);
}

}  // namespace
}  // namespace cradle

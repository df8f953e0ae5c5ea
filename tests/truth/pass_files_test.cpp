#include "truth/pass_files.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

TEST(PassFiles, NumpyFilesHaveTheHeaderOfTheirFormat) {
  const std::string bytes = npyBytes({"flow", 2, std::vector<float>{1, 2, 3, 4, 5, 6}}, 1, 3);
  ASSERT_THAT(bytes, StartsWith(std::string("\x93NUMPY\x01\x00", 8)));
  const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + length) % 64, 0U);
  EXPECT_EQ(bytes.size(), 10 + length + 24);
  EXPECT_EQ(bytes[9 + length], '\n');
  EXPECT_THAT(bytes.substr(10), StartsWith("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 1, 2), }"));
  EXPECT_THAT(npyBytes({"ids", 1, std::vector<std::uint16_t>{1, 2}}, 2, 1).substr(10),
              StartsWith("{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2), }"));
  EXPECT_THAT(npyBytes({"hidden", 1, std::vector<std::uint8_t>{1, 2}}, 2, 1).substr(10), StartsWith("{'descr': '|u1'"));
}

TEST(PassFiles, OpenExrGivesEveryNumberBack) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kSky = std::numeric_limits<float>::infinity();
  const std::vector<float> depth = {1.5f, kSky, 1e-30f, 4, 5, 6};
  const std::vector<float> normal = {1, 2, 3, 4, 5, 6, 7, 8, 9, kNone, kNone, kNone, 13, 14, 15, 16, 17, 18};
  const std::vector<std::uint16_t> ids = {0, 1, 2, 60003, 65535, 7};
  const std::string bytes =
      exrBytes({{"depth", 1, depth}, {"normal", 3, normal}, {"segmentation", 1, ids}}, 3, 2);  // 3 x 2 pixels
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "passes.exr";
  std::ofstream(path, std::ios::binary) << bytes;

  Imf::InputFile file(path.c_str());
  EXPECT_EQ(file.header().dataWindow().max.x, 2);
  EXPECT_EQ(file.header().dataWindow().max.y, 1);
  std::vector<std::string> names;
  for (auto channel = file.header().channels().begin(); channel != file.header().channels().end(); ++channel)
    names.emplace_back(channel.name());
  EXPECT_THAT(names, ElementsAre("depth.V", "normal.X", "normal.Y", "normal.Z", "segmentation.V"));
  std::vector<float> readDepth(6), readY(6);
  std::vector<std::uint32_t> readIds(6);
  Imf::FrameBuffer buffer;
  const auto put = [&](const char* name, Imf::PixelType type, auto& numbers) {
    buffer.insert(name, Imf::Slice(type, reinterpret_cast<char*>(numbers.data()), 4, 12));
  };
  put("depth.V", Imf::FLOAT, readDepth);
  put("normal.Y", Imf::FLOAT, readY);
  put("segmentation.V", Imf::UINT, readIds);
  file.setFrameBuffer(buffer);
  file.readPixels(0, 1);
  EXPECT_EQ(readDepth, depth);
  for (std::size_t pixel = 0; pixel < 6; ++pixel) {
    EXPECT_EQ(readIds[pixel], ids[pixel]);
    if (pixel == 3) {
      EXPECT_TRUE(std::isnan(readY[pixel]));
    } else {
      EXPECT_EQ(readY[pixel], normal[3 * pixel + 1]);
    }
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cradle

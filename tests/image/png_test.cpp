#include "image/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/error.h"
#include "image/temporary_folder.h"
#include "image/test_pictures.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

ErrorKind kindOfFailure(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::different;
}

/// While it lives, no file may grow beyond `bytes`: a write fails as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_;
  void (*handler_)(int);
};

TEST(Png, PictureReadsBackAsItWasWritten) {
  const TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 3), std::pair(640, 361)}) {
    const Image image = makeTestPicture(width, height, 3);
    writePng(image, folder / "a.png");
    EXPECT_EQ(readPng(folder / "a.png"), image) << width << "x" << height;
  }
}

TEST(Png, SamePictureGivesSameBytes) {
  EXPECT_EQ(encodePng(makeTestPicture(300, 200, 1)), encodePng(makeTestPicture(300, 200, 1)));
  EXPECT_NE(encodePng(makeTestPicture(300, 200, 1)), encodePng(makeTestPicture(300, 200, 2)));
}

TEST(Png, BytesDoNotDependOnThePicturesBefore) {
  std::vector<std::vector<std::uint8_t>> first;
  const std::vector<std::pair<int, int>> sizes = {{300, 200}, {9, 5}, {640, 361}, {31, 400}};
  for (int round = 0; round < 3; ++round)
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const std::vector<std::uint8_t> bytes = encodePng(makeTestPicture(sizes[i].first, sizes[i].second, 1));
      if (round == 0) first.push_back(bytes);
      EXPECT_EQ(bytes, first[i]) << i;
    }
  std::vector<std::uint8_t> elsewhere;
  std::thread([&] { elsewhere = encodePng(makeTestPicture(640, 361, 1)); }).join();
  EXPECT_EQ(elsewhere, first[2]);
}

TEST(Png, EveryRowIsFilteredByTheDifferenceToTheLeft) {
  // Every row has a slope of its own: runs of equal bytes with the filter, and nothing alike without.
  Image image(256, 256);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) std::memset(image.at(x, y), (x * (2 * y + 1)) % 256, 3);
  EXPECT_LT(encodePng(image).size(), 256u * 256u * 3u / 50u);
}

TEST(Png, DeviceIsRefusedAndStaysADevice) {
  const Image image = makeTestPicture(4, 4, 0);
  EXPECT_EQ(kindOfFailure([&] { writePng(image, "/dev/full"); }), ErrorKind::output);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(Png, FullDiskIsReportedAndLeavesNothing) {
  const TemporaryFolder folder;
  const Image image = makeTestPicture(200, 200, 0);
  {
    const FileSizeLimit limit(1000);
    EXPECT_EQ(kindOfFailure([&] { writePng(image, folder / "a.png"); }), ErrorKind::output);
  }
  EXPECT_TRUE(folder.isEmpty());
}

TEST(Png, FullDiskKeepsThePictureThatWasThere) {
  const TemporaryFolder folder;
  const Image before = makeTestPicture(10, 10, 0);
  writePng(before, folder / "a.png");
  {
    const FileSizeLimit limit(1000);
    EXPECT_THROW(writePng(makeTestPicture(200, 200, 1), folder / "a.png"), Error);
  }
  EXPECT_EQ(readPng(folder / "a.png"), before);
}

TEST(Png, MissingFolderIsAnOutputError) {
  const TemporaryFolder folder;
  EXPECT_EQ(kindOfFailure([&] { writePng(makeTestPicture(4, 4, 0), folder / "no/a.png"); }), ErrorKind::output);
}

TEST(Png, DamagedFileIsRefused) {
  const TemporaryFolder folder;
  const auto bytes = encodePng(makeTestPicture(50, 50, 0));
  std::ofstream(folder / "half.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size() / 2));
  std::ofstream(folder / "text.png") << "not a picture";
  for (const char* name : {"half.png", "text.png", "missing.png"})
    EXPECT_EQ(kindOfFailure([&] { readPng(folder / name); }), ErrorKind::usage) << name;
}

}  // namespace
}  // namespace cradle

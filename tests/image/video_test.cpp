#include "image/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/interruption.h"
#include "image/child_process.h"
#include "image/png.h"
#include "image/temporary_folder.h"
#include "image/test_pictures.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

/// Another PATH while it lives.
class PathVariable {
 public:
  explicit PathVariable(const std::string& value) : before_(std::getenv("PATH")) { setenv("PATH", value.c_str(), 1); }
  ~PathVariable() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

class Video : public ::testing::Test {
 protected:
  void SetUp() override { noteInterruptions(); }

  void encode(const std::string& path, int width, int height, int count) const {
    VideoEncoder encoder(path, {width, height, 30});
    for (int i = 0; i < count; ++i) encoder.add(makeTestPicture(width, height, static_cast<unsigned>(i)));
    encoder.finish();
  }

  std::string probe(const std::string& path, const std::string& entries) const {
    ChildProcess ffprobe(
        {"ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=" + entries, "-of", "csv=p=0", path});
    EXPECT_EQ(ffprobe.finish(), 0);
    return ffprobe.standardOutput();
  }

  /// The first picture of a film, decoded.
  Image firstPicture(const std::string& path) const {
    ChildProcess ffmpeg({"ffmpeg", "-v", "error", "-i", path, "-frames:v", "1", "-vf",
                         "scale=in_color_matrix=bt709:in_range=tv:out_range=pc,format=rgb24", folder_ / "first.png"});
    EXPECT_EQ(ffmpeg.finish(), 0) << ffmpeg.standardError();
    return readPng(folder_ / "first.png");
  }

  /// A program named ffmpeg that does what `script` says.
  void makeFakeEncoder(const std::string& script) const {
    std::ofstream(folder_ / "ffmpeg") << "#!/bin/sh\n" << script << "\n";
    chmod((folder_ / "ffmpeg").c_str(), 0755);
  }

  /// What goes wrong with a film of `count` pictures, and with which kind.
  std::pair<ErrorKind, std::string> failureOf(const std::string& path, int count) const {
    try {
      encode(path, 320, 240, count);
    } catch (const Error& error) {
      return {error.kind(), error.what()};
    }
    ADD_FAILURE() << "nothing was thrown";
    return {ErrorKind::different, ""};
  }

  TemporaryFolder folder_;
};

TEST_F(Video, HoldsEveryPictureAtItsRate) {
  encode(folder_ / "a.mp4", 64, 48, 17);
  EXPECT_EQ(probe(folder_ / "a.mp4", "width,height,r_frame_rate,nb_read_frames"), "64,48,30/1,17\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4.part"));
}

TEST_F(Video, IsTaggedAsBt709) {
  encode(folder_ / "a.mp4", 64, 48, 2);
  EXPECT_EQ(probe(folder_ / "a.mp4", "pix_fmt,color_range,color_space,color_transfer,color_primaries"),
            "yuv420p,tv,bt709,bt709,bt709\n");
}

TEST_F(Video, ColoursSurviveAsBt709) {
  // A saturated green: with the matrix of bt601 its channels would come back more than 15 levels off.
  Image green(64, 64);
  for (std::size_t i = 0; i < green.pixels.size(); i += 3)
    green.pixels[i] = 30, green.pixels[i + 1] = 200, green.pixels[i + 2] = 40;
  VideoEncoder encoder(folder_ / "a.mp4", {64, 64, 30});
  encoder.add(green);
  encoder.finish();
  const Image back = firstPicture(folder_ / "a.mp4");
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(back.at(32, 32)[channel], green.at(32, 32)[channel], 3) << channel;
}

TEST_F(Video, SamePicturesGiveSameBytes) {
  encode(folder_ / "a.mp4", 320, 240, 30);
  encode(folder_ / "b.mp4", 320, 240, 30);
  EXPECT_FALSE(readBytes(folder_ / "a.mp4").empty());
  EXPECT_EQ(readBytes(folder_ / "a.mp4"), readBytes(folder_ / "b.mp4"));
}

TEST_F(Video, OddSizesGrowByARepeatedEdge) {
  Image image(33, 17);
  std::fill(image.pixels.begin(), image.pixels.end(), std::uint8_t{200});
  VideoEncoder encoder(folder_ / "a.mp4", {33, 17, 30});
  encoder.add(image);
  encoder.finish();
  const Image back = firstPicture(folder_ / "a.mp4");
  EXPECT_EQ(back.width, 34);
  EXPECT_EQ(back.height, 18);
  EXPECT_NEAR(back.at(33, 17)[1], 200, 3);
}

TEST_F(Video, SmallestPictureWorks) {
  encode(folder_ / "a.mp4", 1, 1, 3);
  EXPECT_EQ(probe(folder_ / "a.mp4", "width,height,nb_read_frames"), "2,2,3\n");
}

TEST_F(Video, MissingEncoderIsNamed) {
  const PathVariable path(folder_.path());
  const auto [kind, message] = failureOf(folder_ / "a.mp4", 1);
  EXPECT_EQ(kind, ErrorKind::encoder);
  EXPECT_THAT(message, HasSubstr("install"));
  EXPECT_TRUE(folder_.isEmpty());
}

TEST_F(Video, EncoderThatDiesAtOnceIsReportedWithItsLastWords) {
  makeFakeEncoder("echo 'Unknown encoder libx264' >&2; exit 3");
  const PathVariable path(folder_.path());
  const auto [kind, message] = failureOf(folder_ / "a.mp4", 100);
  EXPECT_EQ(kind, ErrorKind::encoder);
  EXPECT_THAT(message, HasSubstr("code 3"));
  EXPECT_THAT(message, HasSubstr("Unknown encoder libx264"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4"));
}

TEST_F(Video, EncoderThatDiesInMidRunLeavesNothing) {
  makeFakeEncoder("touch " + (folder_ / "a.mp4.part") + "; /usr/bin/head -c 1000000 > /dev/null; kill -SEGV $$");
  const PathVariable path(folder_.path());
  const auto [kind, message] = failureOf(folder_ / "a.mp4", 200);
  EXPECT_EQ(kind, ErrorKind::encoder);
  EXPECT_THAT(message, HasSubstr("code 139"));  // 128 + SIGSEGV
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4.part"));
}

TEST_F(Video, EncoderThatLosesPicturesIsFoundOut) {
  // Takes all bytes and ends well, but leaves a film of one picture.
  makeFakeEncoder(
      "cat > /dev/null; exec /usr/bin/ffmpeg -v error -y -f lavfi -i color=size=64x64:rate=1:duration=1 -f mp4 " +
      (folder_ / "a.mp4.part"));
  const PathVariable path(folder_.path() + ":/usr/bin:/bin");
  const auto [kind, message] = failureOf(folder_ / "a.mp4", 5);
  EXPECT_EQ(kind, ErrorKind::encoder);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4"));
}

TEST_F(Video, UnfinishedFilmLeavesNothing) {
  {
    VideoEncoder encoder(folder_ / "a.mp4", {64, 48, 30});
    for (unsigned i = 0; i < 5; ++i) encoder.add(makeTestPicture(64, 48, i));
  }
  EXPECT_TRUE(folder_.isEmpty());
}

TEST_F(Video, FullDiskIsAnOutputError) {
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{20000, before.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);  // inherited by ffmpeg, whose writes then fail
  setrlimit(RLIMIT_FSIZE, &limit);
  const auto [kind, message] = failureOf(folder_ / "a.mp4", 60);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_EQ(kind, ErrorKind::output) << message;
  EXPECT_TRUE(folder_.isEmpty());
}

TEST_F(Video, DeviceAndFolderAreRefusedBeforeWorkStarts) {
  std::filesystem::create_directory(folder_ / "folder.mp4");
  const VideoFormat format{64, 48, 30};
  for (const std::string& path : {folder_ / "folder.mp4", folder_ / "no/a.mp4"}) {
    try {
      VideoEncoder encoder(path, format);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::output) << path;
    }
  }
  std::filesystem::create_symlink("/dev/full", folder_ / "full.mp4");
  EXPECT_THROW(VideoEncoder(folder_ / "full.mp4", format), Error);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "full.mp4"));
}

TEST_F(Video, OtherEndingIsRefused) {
  try {
    VideoEncoder encoder(folder_ / "a.avi", {64, 48, 30});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
  }
}

TEST_F(Video, FolderOfPicturesIsJoinedInOrderOfNumbers) {
  for (unsigned i = 8; i < 12; ++i)
    writePng(makeTestPicture(64, 48, i),
             folder_ / ("frame_0000" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".png"));
  std::ofstream(folder_ / "notes.txt") << "not a picture";
  long told = 0;
  EXPECT_EQ(encodeFolder(folder_.path(), folder_ / "a.mp4", 30,
                         [&](long done, long total) {
                           told = done;
                           EXPECT_EQ(total, 4);
                         }),
            4);
  EXPECT_EQ(told, 4);

  VideoEncoder direct(folder_ / "b.mp4", {64, 48, 30});
  for (unsigned i = 8; i < 12; ++i) direct.add(makeTestPicture(64, 48, i));
  direct.finish();
  EXPECT_EQ(readBytes(folder_ / "a.mp4"), readBytes(folder_ / "b.mp4"));
}

TEST_F(Video, FolderWithAGapIsRefused) {
  const auto nothing = [](long, long) {};
  EXPECT_THROW(encodeFolder(folder_.path(), folder_ / "a.mp4", 30, nothing), Error);
  writePng(makeTestPicture(64, 48, 0), folder_ / "frame_000000.png");
  writePng(makeTestPicture(64, 48, 2), folder_ / "frame_000002.png");
  try {
    encodeFolder(folder_.path(), folder_ / "a.mp4", 30, nothing);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("frame_000001.png is missing"));
  }
  writePng(makeTestPicture(66, 48, 1), folder_ / "frame_000001.png");
  EXPECT_THROW(encodeFolder(folder_.path(), folder_ / "a.mp4", 30, nothing), Error);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.mp4"));
}

}  // namespace
}  // namespace cradle

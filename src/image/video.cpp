// The only unit that runs ffmpeg. Bytes depend on x264's number of threads, so it is fixed; swscale is told to round
// the same on every CPU; and version strings are left out.

#include "image/video.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>

#include "core/error.h"
#include "core/output_path.h"
#include "image/png.h"

namespace cradle {
namespace {

constexpr const char* kThreads = "4";           // part of the result, hence not the machine's number of cores
constexpr const char* kConstantQuality = "16";  // x264's scale; flat walls and thin rods show no blocks
constexpr std::size_t kLastWords = 600;         // characters of ffmpeg's messages that a user is shown

std::string muxerFor(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".mp4" || extension == ".m4v") return "mp4";
  if (extension == ".mov") return "mov";
  if (extension == ".mkv") return "matroska";
  if (extension == ".gif") return "gif";
  throw Error(ErrorKind::usage, path, "the name of a film ends in .mp4, .mov, .mkv or .gif");
}

int roundedUpToEven(int size) {
  return size + size % 2;
}

/// From picture to picture that the film takes: browsers show those of a .gif for longer than 0.02 s.
long strideOf(const std::string& muxer, const VideoFormat& format) {
  constexpr double kMaxGifRate = 50;  // 1/s
  return muxer == "gif" ? std::lround(std::ceil(format.framesPerSecond / kMaxGifRate)) : 1;
}

std::vector<std::string> ffmpegCommand(const std::string& part, const std::string& muxer, const VideoFormat& format) {
  const std::string size = fmt::format("{}x{}", roundedUpToEven(format.width), roundedUpToEven(format.height));
  std::vector<std::string> command = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y"};
  const auto append = [&](const std::vector<std::string>& more) {
    command.insert(command.end(), more.begin(), more.end());
  };
  append({"-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", size});
  const double rate = format.framesPerSecond / static_cast<double>(strideOf(muxer, format));
  append({"-framerate", fmt::format("{}", rate), "-i", "pipe:0"});
  if (muxer == "gif") {
    append({"-vf", "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer:bayer_scale=4",
            "-threads", "1", "-fflags", "+bitexact", "-f", "gif", "file:" + part});
    return command;
  }
  append({"-vf",
          "scale=in_range=full:out_range=limited:out_color_matrix=bt709:flags=bicubic+accurate_rnd+full_chroma_int+"
          "bitexact,format=yuv420p"});
  append({"-c:v", "libx264", "-preset", "medium", "-crf", kConstantQuality, "-threads", kThreads});
  append({"-color_primaries", "bt709", "-color_trc", "bt709", "-colorspace", "bt709", "-color_range", "tv"});
  append({"-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"});
  if (muxer != "matroska") append({"-movflags", "+faststart"});
  append({"-f", muxer, "file:" + part});
  return command;
}

std::string lastWords(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  if (text.empty()) return "it said nothing";
  if (text.size() > kLastWords) {
    const std::size_t line = text.find('\n', text.size() - kLastWords);
    text = "... " + text.substr(line == std::string::npos ? text.size() - kLastWords : line + 1);
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Whether the file may not grow beyond what it has. A program that a limit stops says nothing of it.
bool isAtLimit(const std::string& path) {
  rlimit limit{};
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && !failed && size >= limit.rlim_cur;
}

bool speaksOfFullDisk(const std::string& text) {
  for (const int error : {ENOSPC, EDQUOT, EFBIG})
    if (text.find(std::strerror(error)) != std::string::npos) return true;
  return false;
}

/// Number of pictures in a film, or -1 if it is no film.
long countFrames(const std::string& path) {
  ChildProcess reader(
      {"ffmpeg", "-v", "error", "-i", "file:" + path, "-map", "0:v:0", "-c", "copy", "-f", "framecrc", "-"});
  if (reader.finish() != 0) return -1;
  const std::string lines = reader.standardOutput();
  long count = 0;
  for (std::size_t start = 0; start < lines.size(); start = std::min(lines.find('\n', start), lines.size()) + 1)
    count += lines[start] != '#';
  return count;
}

/// `image` with its last column and row repeated where its size is odd.
Image paddedToEven(const Image& image) {
  Image padded(roundedUpToEven(image.width), roundedUpToEven(image.height));
  for (int y = 0; y < padded.height; ++y) {
    const int row = std::min(y, image.height - 1);
    std::memcpy(padded.at(0, y), image.at(0, row), static_cast<std::size_t>(image.width) * 3);
    if (padded.width > image.width) std::memcpy(padded.at(image.width, y), image.at(image.width - 1, row), 3);
  }
  return padded;
}

}  // namespace

void requireFilmName(const std::string& path) {
  muxerFor(path);
}

VideoEncoder::VideoEncoder(std::string path, const VideoFormat& format) : path_(std::move(path)), format_(format) {
  CRADLE_CHECK(format.width > 0 && format.height > 0 && format.framesPerSecond > 0);
  const std::string muxer = muxerFor(path_);
  stride_ = strideOf(muxer, format_);
  lock_.emplace(path_);  // ffmpeg writes into that file
  ffmpeg_ = std::make_unique<ChildProcess>(ffmpegCommand(partPath(path_), muxer, format_));
}

VideoEncoder::~VideoEncoder() {
  ffmpeg_.reset();  // before its file goes
}

void VideoEncoder::add(const Image& image) {
  CRADLE_CHECK(image.width == format_.width && image.height == format_.height);
  if (given_++ % stride_ != 0) return;
  const bool isEven = image.width % 2 == 0 && image.height % 2 == 0;
  const Image padded = isEven ? Image() : paddedToEven(image);
  const auto& pixels = isEven ? image.pixels : padded.pixels;
  if (!ffmpeg_->write(pixels.data(), pixels.size())) fail(ffmpeg_->finish());
  ++frames_;
}

void VideoEncoder::finish() {
  CRADLE_CHECK(frames_ > 0 && !finished_);
  const int exitCode = ffmpeg_->finish();
  if (exitCode != 0) fail(exitCode);
  const std::string part = partPath(path_);
  const long count = countFrames(part);
  if (count != frames_ && speaksOfFullDisk(ffmpeg_->standardError())) fail(exitCode);
  if (count != frames_)
    throw Error(ErrorKind::encoder, path_,
                fmt::format("ffmpeg was given {} pictures, and {} can be read back", frames_, count));
  lock_->finish();
  finished_ = true;
}

void VideoEncoder::fail(int exitCode) const {
  const std::string words = ffmpeg_->standardError();
  if (speaksOfFullDisk(words)) throw Error(ErrorKind::output, path_, "cannot be written: " + lastWords(words));
  if (isAtLimit(partPath(path_)))
    throw Error(ErrorKind::output, path_,
                "cannot be written: a limit of the shell (ulimit -f) lets no file grow so far");
  throw Error(ErrorKind::encoder, path_,
              fmt::format("ffmpeg ended with code {} after {} pictures: {}", exitCode, frames_, lastWords(words)));
}

namespace {

/// The pictures of a folder by number.
std::map<long, std::string> findFrames(const std::string& folder) {
  std::error_code failed;
  std::map<long, std::string> frames;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    long number = -1;
    const auto [end, error] =
        std::from_chars(name.data() + std::min<std::size_t>(6, name.size()), name.data() + name.size(), number);
    if (error == std::errc() && number >= 0 && name == fmt::format("frame_{:06}.png", number))
      frames[number] = entry.path().string();
  }
  if (failed) throw Error(ErrorKind::usage, folder, "cannot be read: " + failed.message());
  if (frames.empty()) throw Error(ErrorKind::usage, folder, "holds no pictures named frame_000000.png ...");
  return frames;
}

void requireNoGap(const std::map<long, std::string>& frames, const std::string& folder) {
  long expected = frames.begin()->first;
  for (const auto& [number, name] : frames)
    if (number != expected++)
      throw Error(ErrorKind::usage, folder,
                  fmt::format("frame_{:06}.png is missing; the next there is frame_{:06}.png", expected - 1, number));
}

}  // namespace

long encodeFolder(const std::string& folder, const std::string& path, double framesPerSecond,
                  const std::function<void(long done, long total)>& progress) {
  const auto frames = findFrames(folder);
  requireNoGap(frames, folder);
  const PictureSize size = readPngSize(frames.begin()->second);
  for (const auto& [number, name] : frames)
    if (const PictureSize other = readPngSize(name); other != size)
      throw Error(ErrorKind::usage, name,
                  fmt::format("is {}x{} pixels, the first picture {}x{}; all must have one size", other.width,
                              other.height, size.width, size.height));
  VideoEncoder encoder(path, {size.width, size.height, framesPerSecond});
  long done = 0;
  for (const auto& [number, name] : frames) {
    const Image image = readPng(name);
    if (PictureSize{image.width, image.height} != size) throw Error(ErrorKind::usage, name, "has changed its size");
    encoder.add(image);
    progress(++done, static_cast<long>(frames.size()));
  }
  encoder.finish();
  return done;
}

}  // namespace cradle

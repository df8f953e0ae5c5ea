// The one unit that sees libarchive.

#include "commands/tar_shard.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <tuple>

#include "commands/frame_folder.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/part_file.h"
#include "core/read_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxFile = 100'000'000'000;  // bytes

/// A file of a sample, and its name in the tar file.
struct PackedFile {
  std::string key, ending;  // up to the first point, and behind it
  fs::path path;
};

PackedFile packedFile(const fs::path& path, const std::string& sample) {
  const std::string name = path.filename().string();
  const auto frame = parseFrameFile(name);
  if (!frame) return {sample, name, path};
  const std::string pass = frame->kind == kPictureKind ? "rgb" : frame->kind;
  return {fmt::format("{}_{:06}", sample, frame->frame), pass + path.extension().string(), path};
}

std::vector<PackedFile> filesOf(const fs::path& folder) {
  std::vector<PackedFile> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (!entry.path().filename().string().ends_with(".part"))
      files.push_back(packedFile(entry.path(), folder.filename().string()));
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return std::tie(a.key, a.ending) < std::tie(b.key, b.ending); });
  return files;
}

/// A tar file that is whole or not there.
class TarFile {
 public:
  explicit TarFile(const std::string& path)
      : path_(path), file_(path), archive_(archive_write_new(), archive_write_free) {
    require(archive_write_set_format_pax_restricted(archive_.get()));
    require(archive_write_set_bytes_in_last_block(archive_.get(), 1));
    require(archive_write_open(archive_.get(), &file_, nullptr, &TarFile::take, nullptr));
  }

  void add(const std::string& name, const std::string& bytes) {
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 0, 0);
    require(archive_write_header(archive_.get(), entry.get()));
    if (archive_write_data(archive_.get(), bytes.data(), bytes.size()) < 0) require(ARCHIVE_FATAL);
  }

  void complete() {
    require(archive_write_close(archive_.get()));
    file_.complete();
  }

 private:
  static la_ssize_t take(archive* archive, void* file, const void* bytes, std::size_t count) {
    try {
      static_cast<PartFile*>(file)->write({static_cast<const char*>(bytes), count});
      return static_cast<la_ssize_t>(count);
    } catch (const Error& error) {
      archive_set_error(archive, 0, "%s", error.what());
      return -1;
    }
  }

  void require(int result) const {
    if (result >= ARCHIVE_WARN) return;
    throw Error(ErrorKind::output, path_, fmt::format("cannot be written: {}", archive_error_string(archive_.get())));
  }

  std::string path_;
  PartFile file_;  // outlives the archive, which writes its last bytes when it goes
  std::unique_ptr<archive, decltype(&archive_write_free)> archive_;
};

}  // namespace

void packSamples(const std::string& folder, const std::string& tar, const std::vector<SampleRecord>& samples) {
  TarFile file(tar);
  for (const SampleRecord& sample : samples)
    for (const PackedFile& packed : filesOf(fs::path(folder) / sampleName(sample.number))) {
      throwIfInterrupted();
      file.add(packed.key + "." + packed.ending, readFile(packed.path.string(), kMaxFile, ErrorKind::output));
    }
  file.complete();
}

}  // namespace cradle

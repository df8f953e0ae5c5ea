#include "trajectory/export.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "core/csv_field.h"
#include "core/error.h"
#include "core/output_path.h"

namespace cradle {
namespace {

constexpr const char* kColumns =
    "time_s,frame,body,px_m,py_m,pz_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n";

/// FILE.part, which becomes FILE when complete, and goes when not.
class PartFile {
 public:
  explicit PartFile(const std::string& path) : path_(path), part_(partPath(path)) {
    requireWritableFile(path_);
    requireWritableFile(part_);
    file_ = std::fopen(part_.c_str(), "wb");
    if (file_ == nullptr) fail();
  }
  ~PartFile() {
    if (file_ != nullptr) std::fclose(file_);
    if (!complete_) std::remove(part_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
  }

  void complete() {
    if (std::fclose(std::exchange(file_, nullptr)) != 0) fail();
    requireWritableFile(path_);
    if (std::rename(part_.c_str(), path_.c_str()) != 0) fail();
    complete_ = true;
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(ErrorKind::output, path_, fmt::format("cannot be written ({})", std::strerror(errno)));
  }

  std::string path_, part_;
  std::FILE* file_ = nullptr;
  bool complete_ = false;
};

}  // namespace

void exportCsv(const TrajectoryReader& reader, const std::string& path) {
  std::vector<std::string> names;
  for (const BodyRecord& body : reader.header().bodies)
    if (body.isDynamic) names.push_back(csvField(body.name));

  PartFile file(path);
  file.write(kColumns);
  fmt::memory_buffer lines;
  for (long number = 0; number < reader.frameCount(); ++number) {
    const Frame frame = reader.readFrame(number);
    lines.clear();
    for (std::size_t i = 0; i < names.size(); ++i) {
      fmt::format_to(std::back_inserter(lines), "{},{},{}", frame.time, number, names[i]);
      for (const double value : stateNumbers(frame.states[i])) fmt::format_to(std::back_inserter(lines), ",{}", value);
      lines.push_back('\n');
    }
    file.write({lines.data(), lines.size()});
  }
  file.complete();
}

}  // namespace cradle

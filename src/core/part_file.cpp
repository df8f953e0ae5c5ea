#include "core/part_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "core/output_path.h"

namespace cradle {

PartFile::PartFile(const std::string& path) : path_(path), part_(partPath(path)) {
  requireWritableFile(path_);
  requireWritableFile(part_);
  file_ = std::fopen(part_.c_str(), "wbe");  // e: a program started meanwhile does not hold it open
  if (file_ == nullptr) fail();
}

PartFile::~PartFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!isComplete_) std::remove(part_.c_str());
}

void PartFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
}

void PartFile::complete() {
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail();
  requireWritableFile(path_);
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail();
  isComplete_ = true;
}

void PartFile::fail() const {
  throw Error(ErrorKind::output, path_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace cradle

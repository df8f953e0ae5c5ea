#include "study/growing_table.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/output_path.h"

namespace cradle {

GrowingTable::GrowingTable(const std::string& path, const std::string& columns, std::size_t keptBytes) : path_(path) {
  const std::string part = partPath(path_);
  requireWritableFile(path_);
  requireWritableFile(part);
  std::error_code failed;
  if (keptBytes > 0) std::filesystem::resize_file(part, keptBytes, failed);
  if (failed) throw Error(ErrorKind::output, part, failed.message());
  if (keptBytes == 0) std::remove(part.c_str());
  file_ = std::fopen(part.c_str(), "ab");  // at the end, wherever that is
  if (file_ == nullptr) fail();
  if (keptBytes == 0) append(columns);
}

GrowingTable::~GrowingTable() {
  if (file_ != nullptr) std::fclose(file_);
}

void GrowingTable::append(const std::string& line) {
  if (std::fwrite(line.data(), 1, line.size(), file_) != line.size() || std::fflush(file_) != 0) fail();
}

void GrowingTable::replaceLast(const std::vector<std::string>& lines) {
  const std::string part = partPath(path_);
  std::ifstream file(part, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::size_t kept = text.size();
  for (std::size_t i = 0; i < lines.size(); ++i) kept = text.rfind('\n', kept - 2) + 1;
  std::error_code failed;
  std::filesystem::resize_file(part, kept, failed);
  if (failed) throw Error(ErrorKind::output, part, failed.message());
  append(std::accumulate(lines.begin(), lines.end(), std::string()));
}

void GrowingTable::complete() {
  std::FILE* file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0 || std::rename(partPath(path_).c_str(), path_.c_str()) != 0) fail();
}

void GrowingTable::fail() const {
  throw Error(ErrorKind::output, partPath(path_), std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace cradle

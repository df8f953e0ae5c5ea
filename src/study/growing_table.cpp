#include "study/growing_table.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/output_path.h"
#include "core/part_lock.h"

namespace cradle {

GrowingTable::GrowingTable(const std::string& path, const std::string& columns, std::size_t keptBytes)
    : path_(path), file_(openLockedPart(path)), isKept_(keptBytes > 0) {
  try {
    cutTo(keptBytes);
    if (keptBytes == 0) write(columns);
  } catch (...) {
    end();
    throw;
  }
}

GrowingTable::~GrowingTable() {
  if (file_ >= 0) end();
}

void GrowingTable::end() {
  if (!isKept_) unlink(partPath(path_).c_str());  // while it is locked: later it may be another run's
  close(file_);
}

void GrowingTable::append(const std::string& line) {
  write(line);
  isKept_ = true;
}

void GrowingTable::write(const std::string& text) {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t length = ::write(file_, text.data() + written, text.size() - written);
    if (length < 0 && errno != EINTR) fail();
    if (length > 0) written += static_cast<std::size_t>(length);
  }
}

void GrowingTable::replaceLast(const std::vector<std::string>& lines) {
  const std::string text = wholeText();
  std::size_t kept = text.size();
  for (std::size_t i = 0; i < lines.size(); ++i) kept = text.rfind('\n', kept - 2) + 1;
  cutTo(kept);
  append(std::accumulate(lines.begin(), lines.end(), std::string()));
}

void GrowingTable::complete() {
  flushToDisk(file_, path_);
  if (std::rename(partPath(path_).c_str(), path_.c_str()) != 0) fail();
  close(std::exchange(file_, -1));
  flushFolderOf(path_);
}

std::string GrowingTable::wholeText() const {
  const off_t size = lseek(file_, 0, SEEK_END);
  if (size < 0) fail();
  std::string text(static_cast<std::size_t>(size), '\0');
  if (pread(file_, text.data(), text.size(), 0) != size) fail();
  return text;
}

/// What is appended comes after the first `bytes`.
void GrowingTable::cutTo(std::size_t bytes) {
  const off_t end = static_cast<off_t>(bytes);
  if (ftruncate(file_, end) != 0 || lseek(file_, end, SEEK_SET) != end) fail();
}

void GrowingTable::fail() const {
  throw Error(ErrorKind::output, partPath(path_), std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace cradle

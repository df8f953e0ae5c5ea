#include "study/study_table.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/csv_field.h"
#include "core/error.h"
#include "core/output_path.h"

namespace cradle {
namespace {

constexpr const char* kColumns =
    "scene,engine,method,setting,error,cpu_seconds_per_simulated_second,evaluations,energy_drift,constraint_drift,"
    "penetration,status\n";
constexpr std::array<const char*, 3> kStatusNames = {"ok", "unstable", "failed"};  // in the order of RunStatus

}  // namespace

std::string tableLine(const StudyRow& row) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csvField(row.scene), row.engine, row.method, row.setting,
                     row.error, row.cpuSecondsPerSimulatedSecond, row.evaluations, row.energyDrift, row.constraintDrift,
                     row.penetration, kStatusNames.at(static_cast<std::size_t>(row.status)));
}

StudyTable::StudyTable(const std::string& path) : path_(path) {
  requireWritableFile(path_);
  requireWritableFile(partPath(path_));
  file_ = std::fopen(partPath(path_).c_str(), "wb");
  if (file_ == nullptr) fail();
  write(kColumns);
}

StudyTable::~StudyTable() {
  if (file_ != nullptr) std::fclose(file_);
}

void StudyTable::append(const StudyRow& row) {
  write(tableLine(row));
}

void StudyTable::complete() {
  std::FILE* file = std::exchange(file_, nullptr);
  if (std::fclose(file) != 0 || std::rename(partPath(path_).c_str(), path_.c_str()) != 0) fail();
}

void StudyTable::write(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() || std::fflush(file_) != 0) fail();
}

void StudyTable::fail() const {
  throw Error(ErrorKind::output, partPath(path_), std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace cradle

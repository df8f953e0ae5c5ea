// The two files are written side by side, a scene's reference before its rows: whatever stops a study, each row has its
// reference, and a line that was cut off is the last one.

#include "study/unfinished_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "core/csv_field.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/read_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReferenceFields = 5;
constexpr std::uint64_t kLongestTable = 64'000'000;  // bytes: 400,000 runs, more than all methods have on 1000 scenes

/// Whether a file is there. Anything else at that place is refused: a study does not leave such.
bool isThere(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::symlink_status(path, failed);
  if (fs::is_symlink(status))
    throw Error(ErrorKind::output, path, "is a link; it is not followed: remove it, or choose another folder");
  if (fs::exists(status)) requireRegularFile(path, ErrorKind::output);
  return fs::exists(status);
}

CsvLines linesOf(const std::string& path) {
  std::error_code failed;
  if (!isThere(path) || fs::file_size(path, failed) == 0) return csvLines("");
  return csvLines(readFile(path, kLongestTable, ErrorKind::output));
}

[[noreturn]] void refuse(const std::string& path) {
  throw Error(ErrorKind::output, path,
              "is of another study: of other scenes or methods, or by another build of the program; give the command "
              "that began it to go on, or remove the file to start over");
}

void readReferences(const std::string& path, UnfinishedStudy& study) {
  const CsvLines table = linesOf(path);
  for (std::size_t i = 1; i < table.lines.size(); ++i) {
    const std::vector<std::string>& fields = table.lines[i];
    if (fields.size() != kReferenceFields) refuse(path);
    study.references.push_back(
        {{fields[0], fields[4]}, {{}, std::strtod(fields[1].c_str(), nullptr), fields[2], fields[3]}});
  }
  study.referenceBytes = table.bytes;
}

/// A study that was stopped between its last two renames goes on as if before them.
void takeBackReferences(const std::string& path) {
  if (!isThere(path)) return;
  std::error_code failed;
  fs::rename(path, partPath(path), failed);
  if (failed) throw Error(ErrorKind::output, path, "cannot be renamed: " + failed.message());
}

void readRows(const std::string& path, const CsvLines& table, UnfinishedStudy& study) {
  for (std::size_t i = 1; i < table.lines.size(); ++i) {
    std::optional<StudyRow> row = rowOf(table.lines[i]);
    if (!row || study.referenceOf(row->scene) == nullptr) refuse(path);
    row->isEarlier = true;
    row->message = "as it was before the study was interrupted";
    study.rows.push_back(*row);
  }
  study.rowBytes = table.bytes;
}

}  // namespace

const char* const kReferenceColumns = "scene,uncertainty,made_by,confirmation,made_from\n";

std::string tableLine(const ReferenceLine& line) {
  return fmt::format("{},{},{},{},{}\n", csvField(line.origin.scene), line.reference.uncertainty,
                     csvField(line.reference.madeBy), csvField(line.reference.confirmation), line.origin.hash);
}

std::vector<StudyRow> UnfinishedStudy::rowsOf(const std::string& scene) const {
  std::vector<StudyRow> found;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(found),
               [&](const StudyRow& row) { return row.scene == scene; });
  return found;
}

const ReferenceLine* UnfinishedStudy::referenceOf(const std::string& scene) const {
  const auto found = std::find_if(references.begin(), references.end(),
                                  [&](const ReferenceLine& line) { return line.origin.scene == scene; });
  return found == references.end() ? nullptr : &*found;
}

bool UnfinishedStudy::hasFinished(const std::string& scene) const {
  return referenceOf(scene) != nullptr && references.back().origin.scene != scene;
}

UnfinishedStudy readUnfinishedStudy(const std::string& studyPath, const std::string& referencesPath,
                                    const std::vector<StudyOrigin>& origins) {
  UnfinishedStudy study;
  const std::string rows = partPath(studyPath);
  const bool hasRows = isThere(rows), hasReferences = isThere(partPath(referencesPath));
  if (!hasRows) return study;
  const CsvLines table = linesOf(rows);
  if (table.lines.size() > 1 && !hasReferences) takeBackReferences(referencesPath);
  readReferences(partPath(referencesPath), study);
  readRows(rows, table, study);
  auto next = origins.begin();
  for (const ReferenceLine& line : study.references) {
    next = std::find_if(next, origins.end(), [&](const StudyOrigin& origin) {
      return origin.scene == line.origin.scene && origin.hash == line.origin.hash;
    });
    if (next++ == origins.end()) refuse(rows);
  }
  return study.references.empty() ? UnfinishedStudy{} : study;
}

}  // namespace cradle

#pragma once

#include <string>
#include <vector>

#include "study/study_table.h"

namespace cradle {

/// What the rows of a scene in a study's table follow from.
struct StudyOrigin {
  std::string scene;  // as in the table
  std::string hash;   // of its text, of the methods and of the program
};

/// A line of references.csv: what the errors of a scene are measured against.
struct ReferenceLine {
  StudyOrigin origin;
  Reference reference;  // without its end
};

/// The first line of references.csv, with the newline.
extern const char* const kReferenceColumns;
std::string tableLine(const ReferenceLine& line);

/// What an interrupted study left in study.csv.part and references.csv.part.
struct UnfinishedStudy {
  std::vector<StudyRow> rows;
  std::vector<ReferenceLine> references;         // of the scenes that it came to, in their order
  std::size_t rowBytes = 0, referenceBytes = 0;  // of the two files' complete lines

  /// The rows of a scene.
  std::vector<StudyRow> rowsOf(const std::string& scene) const;
  /// The line of a scene; null without one.
  const ReferenceLine* referenceOf(const std::string& scene) const;
  /// Whether it has been through all methods: a later scene has been begun.
  bool hasFinished(const std::string& scene) const;
};

/// Reads those files of a folder; empty if there are none, or no scene was begun. A references.csv that was renamed
/// before study.csv was gets back its name of an unfinished one. Throws Error(output) if they are not of a study of
/// `origins` (other scenes, in another order, of another content, by other methods or another program), links, larger
/// than 64 MB, or no files at all, of which nothing is read.
UnfinishedStudy readUnfinishedStudy(const std::string& studyPath, const std::string& referencesPath,
                                    const std::vector<StudyOrigin>& origins);

}  // namespace cradle

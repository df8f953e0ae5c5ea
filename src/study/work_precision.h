#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "study/reference.h"

namespace cradle {

/// What one run of one method cost, and what it was good for: a row of study.csv.
struct StudyRow {
  std::string scene, engine = "cradle", method;  // method: its name among studyMethods()
  double setting = 0;                            // time step in s, or accuracy
  double error = std::numeric_limits<double>::quiet_NaN();
  double cpuSecondsPerSimulatedSecond = std::numeric_limits<double>::quiet_NaN();
  double evaluations = std::numeric_limits<double>::quiet_NaN();  // of the right-hand side
  double energyDrift = std::numeric_limits<double>::quiet_NaN();
  double constraintDrift = std::numeric_limits<double>::quiet_NaN();  // m
  double penetration = std::numeric_limits<double>::quiet_NaN();      // m
  RunStatus status = RunStatus::failed;
  std::string message;     // why it is not ok
  bool isEarlier = false;  // read from the table of an interrupted study
};

/// The rows of a scene: those that an interrupted study has, which are handed on instead of being run again, and who
/// takes all of them.
struct RowStream {
  std::vector<StudyRow> earlier;
  std::function<void(const StudyRow&)> take;
};

/// Runs a scene by a method at finer and finer settings until the error is below the reference's uncertainty, does not
/// become less, or the work too much; hands each row on. The plan goes through all accuracies: it may choose another
/// way at each, and a finer one may cost less. A method that fails is not tried again. A scene with something that the
/// method's engine misses has no rows.
void sweep(StudyScene& scene, const std::string& sceneName, const StudyMethod& method, const Reference& reference,
           const RowStream& rows);

/// Times the short runs of a scene once more, in the order of the rows, and keeps what is less: a machine that others
/// use is slow for seconds at a time, and methods that were run at different times are to have the same chance.
/// `done` is told of each row.
void timeInAnotherTurn(StudyScene& scene, const std::vector<StudyMethod>& methods, std::vector<StudyRow>& rows,
                       const std::function<void()>& done);

}  // namespace cradle

#include "study/study_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/csv_field.h"

namespace cradle {
namespace {

constexpr std::array<const char*, 3> kStatusNames = {"ok", "unstable", "failed"};  // in the order of RunStatus
constexpr std::size_t kFields = 11, kFirstNumber = 3;

}  // namespace

const char* const kStudyColumns =
    "scene,engine,method,setting,error,cpu_seconds_per_simulated_second,evaluations,energy_drift,constraint_drift,"
    "penetration,status\n";

std::string tableLine(const StudyRow& row) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csvField(row.scene), row.engine, row.method, row.setting,
                     row.error, row.cpuSecondsPerSimulatedSecond, row.evaluations, row.energyDrift, row.constraintDrift,
                     row.penetration, kStatusNames.at(static_cast<std::size_t>(row.status)));
}

std::optional<StudyRow> rowOf(const std::vector<std::string>& fields) {
  if (fields.size() != kFields) return std::nullopt;
  const auto* const status = std::find(kStatusNames.begin(), kStatusNames.end(), fields.back());
  if (status == kStatusNames.end()) return std::nullopt;
  StudyRow row;
  row.scene = fields[0];
  row.engine = fields[1];
  row.method = fields[2];
  row.status = static_cast<RunStatus>(status - kStatusNames.begin());
  std::size_t field = kFirstNumber;
  for (double* number : {&row.setting, &row.error, &row.cpuSecondsPerSimulatedSecond, &row.evaluations,
                         &row.energyDrift, &row.constraintDrift, &row.penetration}) {
    char* end = nullptr;
    *number = std::strtod(fields[field].c_str(), &end);
    if (fields[field].empty() || *end != '\0') return std::nullopt;
    ++field;
  }
  return row;
}

}  // namespace cradle

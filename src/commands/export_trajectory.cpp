#include "commands/export_trajectory.h"

#include <filesystem>

#include "commands/export_glb.h"
#include "commands/export_html.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "trajectory/export.h"

namespace cradle {
namespace {

void exportTable(const TrajectoryReader& reader, const std::string& path, bool ofContacts, bool quiet) {
  if (ofContacts && !reader.hasContacts())
    throw Error(ErrorKind::usage, reader.path(),
                "tells of no contacts that last, as it is of an earlier version; make it again with `cradle simulate`");
  Progress progress("Exporting", "frames", reader.frameCount(), quiet);
  (ofContacts ? exportContactsCsv : exportCsv)(reader, path, [&](long done) {
    throwIfInterrupted();
    progress.update(done);
  });
}

void exportPage(const std::string& trajectory, const std::optional<std::string>& other, const std::string& output,
                bool quiet) {
  std::optional<TrajectoryReader> beside;
  if (other) beside.emplace(*other);
  exportHtml(TrajectoryReader(trajectory), beside, output, quiet);
}

}  // namespace

void exportTrajectory(const std::string& trajectory, const std::string& output, const ExportOptions& options,
                      bool quiet) {
  requireOtherFile(output, trajectory);
  if (options.other) requireOtherFile(output, *options.other);
  const std::filesystem::path ending = std::filesystem::path(output).extension();
  if (options.ofContacts && ending != ".csv")
    throw Error(ErrorKind::usage, output, "is no table: contacts are exported as FILE.csv");
  if (options.other && ending != ".html")
    throw Error(ErrorKind::usage, output, "shows one trajectory: another one over it is exported as FILE.html");
  if (ending == ".csv")
    exportTable(TrajectoryReader(trajectory), output, options.ofContacts, quiet);
  else if (ending == ".glb")
    exportGlb(TrajectoryReader(trajectory), output, quiet);
  else if (ending == ".html")
    exportPage(trajectory, options.other, output, quiet);
  else
    throw Error(ErrorKind::usage, output,
                "cannot tell the format from the name; allowed are FILE.csv, FILE.glb and FILE.html");
}

}  // namespace cradle

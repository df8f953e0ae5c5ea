#include "commands/export_trajectory.h"

#include <filesystem>

#include "commands/export_glb.h"
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

}  // namespace

void exportTrajectory(const std::string& trajectory, const std::string& output, bool exportsContacts, bool quiet) {
  requireOtherFile(output, trajectory);
  const std::filesystem::path ending = std::filesystem::path(output).extension();
  if (exportsContacts && ending != ".csv")
    throw Error(ErrorKind::usage, output, "is no table: contacts are exported as FILE.csv");
  if (ending == ".csv")
    exportTable(TrajectoryReader(trajectory), output, exportsContacts, quiet);
  else if (ending == ".glb")
    exportGlb(TrajectoryReader(trajectory), output, quiet);
  else
    throw Error(ErrorKind::usage, output, "cannot tell the format from the name; allowed are FILE.csv and FILE.glb");
}

}  // namespace cradle

#include "commands/export_html.h"

#include <map>
#include <string_view>

#include "commands/embedded_player.h"
#include "commands/player_document.h"
#include "commands/trajectory_source.h"
#include "core/interruption.h"
#include "core/markup.h"
#include "core/part_file.h"
#include "core/progress.h"

namespace cradle {
namespace {

/// The page with what stands in it for each {{NAME}}.
void writePage(const std::map<std::string, std::string>& parts, PartFile& file) {
  std::string_view rest = parts.at("player.html");
  for (;;) {
    const std::size_t begin = rest.find("{{");
    file.write(rest.substr(0, begin));
    if (begin == std::string_view::npos) return;
    const std::size_t end = rest.find("}}", begin);
    file.write(parts.at(std::string(rest.substr(begin + 2, end - begin - 2))));
    rest.remove_prefix(end + 2);
  }
}

}  // namespace

void exportHtml(TrajectoryReader reader, const std::optional<TrajectoryReader>& other, const std::string& path,
                bool quiet) {
  PartFile file(path);
  TrajectorySource source(std::move(reader), quiet);
  Progress progress("Exporting", "frames", source.frameCount(), quiet);
  std::map<std::string, std::string> parts = embeddedPlayer();
  parts["title"] = escapedMarkup(source.scene().name);
  parts["motion"] = playerDocument(source, other ? &*other : nullptr, [&](long done) {
    throwIfInterrupted();
    progress.update(done);
  });
  writePage(parts, file);
  file.complete();
}

}  // namespace cradle

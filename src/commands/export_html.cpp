#include "commands/export_html.h"

#include <string_view>
#include <utility>

#include "core/interruption.h"
#include "core/part_file.h"
#include "core/progress.h"
#include "film/film_source.h"
#include "player/player_page.h"

namespace cradle {

void exportHtml(TrajectoryReader reader, const std::optional<TrajectoryReader>& other, const std::string& path,
                bool quiet) {
  PartFile file(path);
  FilmSource motion(std::move(reader));
  Progress progress("Exporting", "frames", motion.frameCount(), quiet);
  writePlayerPage(
      motion, other ? &*other : nullptr,
      [&](long done) {
        throwIfInterrupted();
        progress.update(done);
      },
      [&](std::string_view text) { file.write(text); });
  file.complete();
}

}  // namespace cradle

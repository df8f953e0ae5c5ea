#include "player/player_page.h"

#include <map>
#include <string>

#include "core/markup.h"
#include "player/embedded_player.h"
#include "player/player_document.h"

namespace cradle {

void writePlayerPage(FilmSource& motion, const TrajectoryReader* other, const std::function<void(long done)>& progress,
                     const std::function<void(std::string_view)>& write) {
  std::map<std::string, std::string> parts = embeddedPlayer();
  parts["title"] = escapedMarkup(motion.scene().name);
  parts["motion"] = playerDocument(motion, other, progress);
  std::string_view rest = parts.at("player.html");  // with {{NAME}} where a part stands
  for (std::size_t begin = rest.find("{{"); begin != std::string_view::npos; begin = rest.find("{{")) {
    write(rest.substr(0, begin));
    const std::size_t end = rest.find("}}", begin);
    write(parts.at(std::string(rest.substr(begin + 2, end - begin - 2))));
    rest.remove_prefix(end + 2);
  }
  write(rest);
}

}  // namespace cradle

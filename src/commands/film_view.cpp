#include "commands/film_view.h"

#include <algorithm>

namespace cradle {

View viewOf(const TrajectorySource& source, int width, int height) {
  const TrajectoryReader& reader = source.reader();
  const auto pushes = findShownPushes(source.scene(), reader.events(), [&reader](long frame) {
    return reader.readFrame(std::min(frame, reader.frameCount() - 1));
  });
  Framing framing(source.scene(), width, height, pushes);
  for (long frame = 0; frame < reader.frameCount(); ++frame) framing.add(reader.readFrame(frame));
  return framing.view();
}

}  // namespace cradle

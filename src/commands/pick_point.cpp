#include "commands/pick_point.h"

#include <fmt/format.h>

#include <cmath>

#include "commands/picture_order.h"
#include "commands/trajectory_source.h"
#include "commands/truth_film.h"
#include "core/console.h"
#include "core/error.h"
#include "core/printable.h"
#include "scene/fault_list.h"

namespace cradle {
namespace {

/// Column and row: two numbers with a comma.
Eigen::Vector2d parsePixel(const std::string& text, const PictureSize& size) {
  std::size_t afterColumn = 0, afterRow = 0;
  double column = -1, row = -1;
  const std::size_t comma = text.find(',');
  try {
    column = std::stod(text.substr(0, comma), &afterColumn);
    row = std::stod(text.substr(comma == std::string::npos ? text.size() : comma + 1), &afterRow);
  } catch (const std::logic_error&) {  // no number, or one beyond all doubles
  }
  const bool isPair = afterColumn == comma && comma + 1 + afterRow == text.size();
  if (!isPair || !(column >= 0 && column < size.width && row >= 0 && row < size.height))
    throw Error(
        ErrorKind::usage, "pixel",
        fmt::format("found \"{}\"; allowed is COLUMN,ROW, from 0,0 to {},{}", text, size.width - 1, size.height - 1));
  return {column, row};
}

/// Numbers with as many digits as give the same bits, as JSON.
std::string arrayOf(const Vec3& vector) {
  return fmt::format("[{}, {}, {}]", vector.x(), vector.y(), vector.z());
}

const char* nounOf(LinkKind kind, const Scene& scene) {
  const char* noun = "";
  forEachKindOfLink(scene, [&](const auto& links) {
    if (LinkOf<decltype(links)>::kKind == kind) noun = LinkOf<decltype(links)>::kNoun;
  });
  return noun;
}

void showVertex(const Scene& scene, const Body& body, const Vec3& point) {
  const auto* shape = std::get_if<ModelShape>(&body.shape);
  if (shape == nullptr) return;
  const std::vector<Vec3>& vertices = scene.models[static_cast<std::size_t>(shape->model)].solid.vertices;
  const std::size_t nearest = nearestVertex(vertices, point);
  show("  nearest vertex           {} at {} m, {:.6g} m away\n", nearest, arrayOf(vertices[nearest]),
       (vertices[nearest] - point).norm());
}

}  // namespace

void pickPoint(const std::string& input, long frame, const std::string& pixel, const PictureOptions& options,
               bool quiet) {
  TrajectorySource source(input, quiet, {.assetRoot = options.assetRoot});
  const PictureOrder order = pictureOrderOf(options, source.scene());
  const Eigen::Vector2d place = parsePixel(pixel, order.size);
  if (frame < 0 || frame >= source.frameCount())
    throw Error(ErrorKind::usage, "--frame",
                fmt::format("found {}; allowed are frames from 0 to {}", frame, source.frameCount() - 1));
  if (isSeenFromTheStart(source.scene()))
    source.simulateBeside([](const std::string&) {}, nullptr);  // no further than to that frame
  else
    source.simulate();
  TruthFilm film(source, viewOf(source, order.size.width, order.size.height), order.size.width, order.size.height, {});
  FrameRays& rays = film.raysOf(frame);
  const double x = place.x() + 0.5, y = place.y() + 0.5;
  const SeenPoint seen = rays.rays().seenAt(x, y);
  const std::string where = fmt::format("pixel {},{} of frame {}", place.x(), place.y(), frame);
  if (seen.isSky()) return show("{}: the sky\n", where);
  const SeenSurface& surface = rays.surfaces()[static_cast<std::size_t>(seen.surface)];
  if (surface.body == kWorld) return show("{}: a {}\n", where, nounOf(*surface.link, source.scene()));
  const Scene& scene = source.scene();
  const Body& body = scene.bodies[static_cast<std::size_t>(surface.body)];
  const Quat turn = source.worldFromDrawn();
  const Vec3 drawn = rays.rays().pointAt(x, y, seen);
  const Vec3 point = rays.worldFromBody()[static_cast<std::size_t>(surface.body)].inverse() * drawn;
  const Vec3 normal = turn * rays.rays().normalAt(x, y, seen);
  const std::string name = inQuotes(body.name);
  show("{}: body {}\n", where, printableLine(name));
  show("  point in its frame       {} m\n", arrayOf(point));
  show("  point in the world       {} m\n", arrayOf(turn * drawn));
  show("  normal, in the world     {}\n", arrayOf(normal));
  show("  depth along the view     {} m\n", seen.depth);
  showVertex(scene, body, point);
  constexpr double kForce = 3;  // N: as large as that of a push without one
  show("to paste into a scene:\n");
  if (body.motion != Motion::dynamic)
    return show("  \"bodyB\": {}, \"anchorB\": {}\n", printableLine(name), arrayOf(point));
  show("  {{\"body\": {}, \"point\": {}, \"force\": {}}}\n", printableLine(name), arrayOf(point),
       arrayOf(-kForce * normal));
  show("  \"bodyA\": {}, \"anchorA\": {}\n", printableLine(name), arrayOf(point));
}

}  // namespace cradle

#include "verify/check_surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "verify/placed_solid.h"
#include "verify/single_precision.h"

namespace cradle {
namespace {

constexpr double kDouble = 1e-14;             // a dozen operations in double precision, and then some
constexpr double kBefore = 2 * kSingleRatio;  // of the depth, by which something is surely before what is seen
constexpr double kAwayFromCamera = 1e-6;      // cosine between a normal and the view, of a surface seen along itself

std::string wordsOf(const Vec3& vector) {
  return fmt::format("[{:.9g} {:.9g} {:.9g}]", vector.x(), vector.y(), vector.z());
}

Vec3 vectorAt(const std::vector<float>& numbers, std::size_t pixel) {
  return {static_cast<double>(numbers[3 * pixel]), static_cast<double>(numbers[3 * pixel + 1]),
          static_cast<double>(numbers[3 * pixel + 2])};
}

/// How many pixels a solid covers, and where: of those that it meets for sure, or by rounding.
struct Cover {
  long pixels = 0;
  long left = std::numeric_limits<long>::max(), top = left, right = -1, bottom = -1;  // half-open

  void add(long x, long y) {
    ++pixels;
    left = std::min(left, x), right = std::max(right, x + 1);
    top = std::min(top, y), bottom = std::max(bottom, y + 1);
  }
};

struct Silhouette {
  Cover sure, possible;
};

/// A pixel, and the ray through its centre.
struct PixelRay {
  std::size_t pixel;
  int x, y;
  PictureRay ray;
};

class SurfaceCheck {
 public:
  SurfaceCheck(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings)
      : film_(film),
        frame_(frame),
        camera_(film.cameras.frames[static_cast<std::size_t>(frame.number)]),
        solids_(solidsOf(film.scene, frame.worldFromBody, camera_.position())),
        silhouettes_(solids_.size()),
        findings_(findings) {}

  void checkPixels();
  void checkSilhouettes();

 private:
  FoundPlace placeIn(const char* kind, const PixelRay& at) const { return {frame_.fileOf(kind), at.x, at.y}; }
  const char* kindOfIds() const { return frame_.segmentation.empty() ? "instances" : "segmentation"; }
  std::string nameOfId(int id) const;
  void checkId(const PixelRay& at);
  void checkSkyAndSides(const PixelRay& at);
  void checkSolids(const PixelRay& at);
  void checkOwn(const PlacedSolid& solid, const DepthRange& range, const PixelRay& at);
  void checkNothingBefore(const PlacedSolid& solid, const DepthRange& range, double depth, const PixelRay& at);
  void checkMesh(const PixelRay& at);
  void checkCoordinates(const PixelRay& at);
  double knownDepth(const PixelRay& at, const std::optional<DepthRange>& own) const;

  const VerifiedFilm& film_;
  const TruthFrame& frame_;
  const TruthCamera camera_;
  const std::vector<PlacedSolid> solids_;
  std::vector<Silhouette> silhouettes_;
  std::vector<std::pair<std::size_t, DepthRange>> met_;  // of the pixel at hand
  Findings& findings_;
};

std::string SurfaceCheck::nameOfId(int id) const {
  if (id == 0) return "the sky";
  if (id >= kFirstIdOfLinks) return fmt::format("a link ({})", id);
  const std::size_t body = static_cast<std::size_t>(id - 1);
  return body < film_.scene.bodies.size() ? fmt::format("body \"{}\" ({})", film_.scene.bodies[body].name, id)
                                          : fmt::format("nothing of the scene ({})", id);
}

void SurfaceCheck::checkPixels() {
  std::size_t pixel = 0;
  for (int y = 0; y < film_.cameras.height; ++y)
    for (int x = 0; x < film_.cameras.width; ++x, ++pixel) {
      const PixelRay at{pixel, x, y, {camera_.position(), camera_.rayAt(x + 0.5, y + 0.5)}};
      checkId(at);
      checkSkyAndSides(at);
      checkSolids(at);
      checkMesh(at);
      checkCoordinates(at);
    }
}

/// Ids are those of something in the scene.
void SurfaceCheck::checkId(const PixelRay& at) {
  const int id = frame_.ids[at.pixel];
  if (id == kUnknownId) return;
  const bool isBody = id <= static_cast<int>(film_.scene.bodies.size());
  bool isLink = false;
  forEachKindOfLink(film_.scene, [&](const auto& links) {
    isLink = isLink || (!links.empty() && id == kFirstIdOfLinks + static_cast<int>(LinkOf<decltype(links)>::kKind));
  });
  findings_.add(Aspect::segmentation, isBody || isLink ? 0 : 1, kBefore, [&] {
    return Fault{placeIn(kindOfIds(), at), nameOfId(id), "the sky, or a body or link of the scene"};
  });
}

/// The sky has no numbers, and what is seen has: a finite depth, and a unit normal towards the camera.
void SurfaceCheck::checkSkyAndSides(const PixelRay& at) {
  const int id = frame_.ids[at.pixel];
  if (id == kUnknownId) return;
  if (!frame_.depth.empty()) {
    const double depth = static_cast<double>(frame_.depth[at.pixel]);
    const bool isRight = id == 0 ? depth == std::numeric_limits<double>::infinity() : depth > 0 && std::isfinite(depth);
    findings_.add(Aspect::depth, isRight ? 0 : 1, kSingleRatio, [&] {
      return Fault{placeIn("depth", at), fmt::format("{} m", depth),
                   id == 0 ? "inf, for the sky" : "a finite depth of " + nameOfId(id)};
    });
  }
  if (frame_.normal.empty()) return;
  const Vec3 normal = vectorAt(frame_.normal, at.pixel);
  if (id == 0) {
    findings_.add(Aspect::normal, normal.array().isNaN().all() ? 0 : 1, kSingleRatio, [&] {
      return Fault{placeIn("normal", at), wordsOf(normal), "NaN, for the sky"};
    });
    return;
  }
  findings_.add(Aspect::normal, std::abs(normal.norm() - 1), 2 * kSingleRatio, [&] {
    return Fault{placeIn("normal", at), fmt::format("{} of length {:.9g}", wordsOf(normal), normal.norm()), "length 1"};
  });
  const double away = normal.dot(at.ray.direction.normalized());
  findings_.add(Aspect::normal, std::max(away, 0.0), kAwayFromCamera, [&] {
    return Fault{placeIn("normal", at), wordsOf(normal) + ", away from the camera", "the side of the camera"};
  });
}

/// In m, along the view: as the folder says, else as a solid's form does; NaN if neither does.
double SurfaceCheck::knownDepth(const PixelRay& at, const std::optional<DepthRange>& own) const {
  if (!frame_.depth.empty()) return static_cast<double>(frame_.depth[at.pixel]);
  if (frame_.ids[at.pixel] == 0) return std::numeric_limits<double>::infinity();
  return own ? own->most : std::numeric_limits<double>::quiet_NaN();
}

void SurfaceCheck::checkSolids(const PixelRay& at) {
  met_.clear();
  const int id = frame_.ids[at.pixel];
  std::optional<DepthRange> own;
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const auto range = solids_[i].meet(at.ray);
    const bool isOwn = solids_[i].body() + 1 == id;
    if (isOwn) {
      findings_.add(Aspect::segmentation, range ? 0 : 1, kBefore, [&] {
        return Fault{placeIn(kindOfIds(), at), nameOfId(id), "something else: the ray through the centre misses it"};
      });
      own = range;
    }
    if (!range) continue;
    silhouettes_[i].possible.add(at.x, at.y);
    if (range->isSure) silhouettes_[i].sure.add(at.x, at.y);
    if (isOwn)
      checkOwn(solids_[i], *range, at);
    else if (range->isSure)
      met_.emplace_back(i, *range);
  }
  const double depth = knownDepth(at, own);
  for (const auto& [solid, range] : met_) checkNothingBefore(solids_[solid], range, depth, at);
}

void SurfaceCheck::checkOwn(const PlacedSolid& solid, const DepthRange& range, const PixelRay& at) {
  if (!frame_.depth.empty()) {
    const double depth = static_cast<double>(frame_.depth[at.pixel]);
    const double beyond = std::max({0.0, range.least - depth, depth - range.most});
    findings_.add(Aspect::depth, std::isnan(depth) ? depth : beyond / range.most, kSingleRatio, [&] {
      return Fault{placeIn("depth", at), fmt::format("{:.9g} m", depth),
                   fmt::format("{:.9g} m, where the ray meets {}", range.middle(), nameOfId(solid.body() + 1))};
    });
  }
  if (frame_.normal.empty()) return;
  const Vec3 normal = vectorAt(frame_.normal, at.pixel);
  const auto [deviation, tolerance, expected] = solid.compareNormal(at.ray, range, normal);
  findings_.add(Aspect::normal, deviation, tolerance, [&, toward = expected] {
    return Fault{placeIn("normal", at), wordsOf(normal), wordsOf(toward) + " of " + nameOfId(solid.body() + 1)};
  });
}

void SurfaceCheck::checkNothingBefore(const PlacedSolid& solid, const DepthRange& range, double depth,
                                      const PixelRay& at) {
  if (std::isnan(depth)) return;
  const double nearer = std::isinf(depth) ? 1 : std::max(0.0, (depth - range.most) / depth);
  findings_.add(Aspect::segmentation, nearer, kBefore, [&] {
    return Fault{placeIn(kindOfIds(), at),
                 fmt::format("{} at {:.9g} m",
                             frame_.ids[at.pixel] == kUnknownId ? "no body" : nameOfId(frame_.ids[at.pixel]), depth),
                 fmt::format("{} before it, at {:.9g} m", nameOfId(solid.body() + 1), range.most)};
  });
}

/// What is seen of a mesh is on one of its triangles, which has that normal.
void SurfaceCheck::checkMesh(const PixelRay& at) {
  const std::size_t body = static_cast<std::size_t>(frame_.ids[at.pixel]) - 1;  // beyond all, of what is no body
  if (frame_.depth.empty() || body >= film_.scene.bodies.size()) return;
  const auto* model = std::get_if<ModelShape>(&film_.scene.bodies[body].shape);
  if (model == nullptr) return;
  const RigidTransform& place = frame_.worldFromBody[body];
  const Mat3 bodyFromWorld = place.rotation.toRotationMatrix().transpose();
  const double depth = static_cast<double>(frame_.depth[at.pixel]);
  if (!std::isfinite(depth)) return;  // told as a fault already
  const Vec3 local = bodyFromWorld * (at.ray.origin + depth * at.ray.direction - place.translation);
  const double far = at.ray.origin.norm() + place.translation.norm() + depth * at.ray.direction.norm();
  const double reach = kSingleRatio * depth * at.ray.direction.norm() + kDouble * far;
  const Vec3 normal = frame_.normal.empty() ? Vec3(Vec3::Zero()) : vectorAt(frame_.normal, at.pixel);
  const DrawnSurface::Match match =
      film_.meshes[static_cast<std::size_t>(model->model)].match(local, bodyFromWorld * normal, reach, kDouble * far);
  findings_.add(Aspect::depth, match.distance / (reach / kSingleRatio), kSingleRatio, [&] {
    return Fault{placeIn("depth", at), fmt::format("{:.9g} m", depth),
                 fmt::format("a depth on the surface of {}, {:.3g} m or more away", nameOfId(frame_.ids[at.pixel]),
                             match.distance)};
  });
  if (frame_.normal.empty() || match.distance > reach) return;
  findings_.add(Aspect::normal, match.normalDeviation, match.normalTolerance, [&] {
    return Fault{placeIn("normal", at), wordsOf(normal), "that of a triangle of " + nameOfId(frame_.ids[at.pixel])};
  });
}

/// A point in a body's frame is on the ray of its pixel, at the depth that the folder says.
void SurfaceCheck::checkCoordinates(const PixelRay& at) {
  const int id = frame_.ids[at.pixel];
  const bool isNothing = id > static_cast<int>(film_.scene.bodies.size()) && id < kFirstIdOfLinks;
  if (frame_.objectCoordinates.empty() || id == kUnknownId || isNothing) return;
  const Vec3 local = vectorAt(frame_.objectCoordinates, at.pixel);
  if (id == 0 || id >= kFirstIdOfLinks) {
    findings_.add(Aspect::objectCoordinates, local.array().isNaN().all() ? 0 : 1, kSingleRatio, [&] {
      return Fault{placeIn("objectCoordinates", at), wordsOf(local), "NaN, for " + nameOfId(id)};
    });
    return;
  }
  const RigidTransform& place = frame_.worldFromBody[static_cast<std::size_t>(id - 1)];
  const Vec3 point = place.rotation.toRotationMatrix() * local + place.translation;
  const double depth = frame_.depth.empty() ? camera_.seen(point).z() : static_cast<double>(frame_.depth[at.pixel]);
  const Vec3 seen = at.ray.origin + depth * at.ray.direction;
  const double size = local.norm() + depth * at.ray.direction.norm() +
                      1e-8 * (at.ray.origin.norm() + place.translation.norm());  // double precision beside single
  findings_.add(Aspect::objectCoordinates, (point - seen).norm(), kSingleRatio * size, [&] {
    return Fault{placeIn("objectCoordinates", at), fmt::format("{}, in the world {}", wordsOf(local), wordsOf(point)),
                 fmt::format("{} in the world, of {}", wordsOf(seen), nameOfId(id))};
  });
}

/// The pixels that a solid covers, hidden or not, are those of its annotation, but for rays that just touch it.
void SurfaceCheck::checkSilhouettes() {
  const std::string file = truthFileName("instances", frame_.number);
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const Cover &sure = silhouettes_[i].sure, &possible = silhouettes_[i].possible;
    const auto& annotations = frame_.instances.annotations;
    const auto record = std::find_if(annotations.begin(), annotations.end(), [&](const InstanceRecord& candidate) {
      return candidate.id == solids_[i].body() + 1;
    });
    const InstanceRecord found = record == annotations.end() ? InstanceRecord{} : *record;
    const std::string name = nameOfId(solids_[i].body() + 1);
    const long off = std::max({0L, sure.pixels - found.wholeArea, found.wholeArea - possible.pixels});
    findings_.add(Aspect::silhouette, static_cast<double>(off), 0, [&] {
      return Fault{{file},
                   fmt::format("wholeArea {} of {}", found.wholeArea, name),
                   fmt::format("{} to {}", sure.pixels, possible.pixels)};
    });
    if (sure.pixels == 0 || off > 0) continue;
    const auto& [left, top, width, height] = found.wholeBox;
    const long beside = std::max({0L, possible.left - left, left - sure.left, possible.top - top, top - sure.top,
                                  sure.right - left - width, left + width - possible.right, sure.bottom - top - height,
                                  top + height - possible.bottom});
    findings_.add(Aspect::silhouette, static_cast<double>(beside), 0, [&, l = left, t = top, w = width, h = height] {
      return Fault{{file},
                   fmt::format("wholeBox [{} {} {} {}] of {}", l, t, w, h, name),
                   fmt::format("[{} {} {} {}]", sure.left, sure.top, sure.right - sure.left, sure.bottom - sure.top)};
    });
  }
}

}  // namespace

void checkSurfaces(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings) {
  SurfaceCheck check(film, frame, findings);
  check.checkPixels();
  check.checkSilhouettes();
}

}  // namespace cradle

#include "scene/complete_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/picked_points.h"

namespace cradle {
namespace {

// Of the size of what is joined: nobody writes coordinates with more digits, and projection removes what is below.
constexpr double kGapTolerance = 1e-6;

const BodyDraft& draftOf(int body, const SceneDraft& scene) {
  return scene.bodies[scene.draftOfBody[static_cast<std::size_t>(body)]];
}

/// Whether all is there that says where an end is: of one that is picked, whatever may be before its body.
bool isKnown(const AnchorDraft& end, const SceneDraft& scene) {
  const auto hasShape = [](const BodyDraft& body) { return body.size.has_value(); };
  if (end.pick) return std::all_of(scene.bodies.begin(), scene.bodies.end(), hasShape);
  return end.anchor.body == kWorld || hasShape(draftOf(end.anchor.body, scene));
}

void resolveVertex(AnchorDraft& anchor, const SceneDraft& scene, FaultList& faults) {
  if (!anchor.isOfMesh()) return;
  const Body& body = scene.scene.bodies[static_cast<std::size_t>(anchor.anchor.body)];
  const auto model = static_cast<std::size_t>(std::get<ModelShape>(body.shape).model);
  const std::vector<Vec3>& vertices = scene.scene.models[model].solid.vertices;
  const auto index =
      anchor.nearestTo ? nearestVertex(vertices, *anchor.nearestTo) : static_cast<std::size_t>(*anchor.vertex);
  if (index < vertices.size()) {
    anchor.anchor.point = vertices[index];
  } else {
    addFault(faults, anchor.field,
             fmt::format("vertex is {}; allowed is a whole number in 0..{}, the vertices of {}", index,
                         vertices.size() - 1, inQuotes(scene.scene.models[model].name)));
  }
}

Vec3 worldPoint(const Anchor& anchor, const SceneDraft& scene) {
  if (anchor.body == kWorld) return anchor.point;
  return scene.scene.bodies[static_cast<std::size_t>(anchor.body)].worldFromBody * anchor.point;
}

// The largest body that can move: others may be whole landscapes.
double sizeOf(const LinkDraft& link, const SceneDraft& scene) {
  double size = 0;
  for (const int body : {link.anchorA.anchor.body, link.anchorB.anchor.body}) {
    if (body == kWorld || draftOf(body, scene).body.motion != Motion::dynamic) continue;
    size = std::max(size, *draftOf(body, scene).size);
  }
  return size;
}

/// A link with its ends where they are at the start: for each kind, what follows from that.
class Settlement {
 public:
  Settlement(LinkDraft& link, double distance, double size, FaultList& faults)
      : link_(link), distance_(distance), size_(size), faults_(faults) {}

  void operator()(Spring& spring) const {
    if (!link_.length) spring.restLength = distance_;
  }
  void operator()(Rod& rod) const;
  void operator()(Rope& rope) const;
  template <class Joint>
  void operator()(Joint&) const {
    checkThatEndsMeet();
  }

 private:
  void checkThatEndsMeet() const;
  bool isApart(const char* key, const char* remedy) const;

  LinkDraft& link_;
  double distance_, size_;  // m
  FaultList& faults_;
};

// A length that follows from the distance at the start needs one.
bool Settlement::isApart(const char* key, const char* remedy) const {
  if (distance_ > 0) return true;
  addFault(faults_, link_.field,
           fmt::format("{0} is not given and the ends coincide at the start; {0} must be > 0; {1}", key, remedy));
  return false;
}

void Settlement::operator()(Rod& rod) const {
  if (!link_.length) {
    if (isApart("length", "move an anchor, or use a ball joint")) rod.length = distance_;
    return;
  }
  const double tolerance = kGapTolerance * std::max(size_, rod.length);
  if (std::abs(distance_ - rod.length) <= tolerance) return;
  addFault(
      faults_, *link_.length,
      fmt::format("length is {} m, but the ends are {} m apart at the start; they may differ by {:.3g} m; leave out "
                  "length, or move an end",
                  rod.length, distance_, tolerance));
}

void Settlement::operator()(Rope& rope) const {
  if (!link_.length) {
    if (isApart("maxLength", "give one")) rope.maxLength = distance_;
    return;
  }
  if (distance_ <= rope.maxLength + kGapTolerance * std::max(size_, rope.maxLength)) return;
  addFault(faults_, *link_.length,
           fmt::format("maxLength is {} m, but the ends are {} m apart at the start; a rope must be at least as long",
                       rope.maxLength, distance_));
}

void Settlement::checkThatEndsMeet() const {
  const double tolerance = kGapTolerance * size_;
  if (distance_ <= tolerance) return;
  addFault(faults_, link_.field,
           fmt::format("the anchors are {:.6g} m apart at the start; those of a joint must meet within {:.3g} m",
                       distance_, tolerance));
}

void complete(LinkDraft& link, SceneDraft& scene, FaultList& faults) {
  link.isSettled = true;
  const std::size_t faultsBefore = faults.count();
  for (AnchorDraft* end : {&link.anchorA, &link.anchorB}) {
    resolveVertex(*end, scene, faults);
    if (end->pick)
      end->anchor.point = pickedPoint(*end->pick, end->anchor.body, scene.scene, faults).value_or(Vec3::Zero());
  }
  if (faults.count() != faultsBefore) return;
  const Vec3 difference = worldPoint(link.anchorA.anchor, scene) - worldPoint(link.anchorB.anchor, scene);
  const double distance = difference.stableNorm();
  if (!std::isfinite(distance)) {
    addFault(faults, link.field, "the distance of the ends overflows; bring them closer");
    return;
  }
  std::visit(Settlement(link, distance, sizeOf(link, scene), faults), link.link);
}

}  // namespace

void completeLinks(SceneDraft& draft, FaultList& faults) {
  std::size_t picks = 0;
  for (LinkDraft& link : draft.links) {
    if (link.isSettled || !link.isSound) continue;
    if ((link.anchorA.pick || link.anchorB.pick) && ++picks > kMaxPicks)
      return addFault(
          faults, link.field,
          fmt::format("from here on, more than {} links have ends that are picked; give points", kMaxPicks));
    if (isKnown(link.anchorA, draft) && isKnown(link.anchorB, draft)) complete(link, draft, faults);
  }
}

void collectLinks(SceneDraft& draft) {
  Scene& scene = draft.scene;
  for (LinkDraft& draftLink : draft.links) {
    CRADLE_CHECK(draftLink.isSettled);
    std::visit(
        [&](auto& link) {
          link.anchorA = draftLink.anchorA.anchor;
          link.anchorB = draftLink.anchorB.anchor;
          forEachKindOfLink(scene, [&link](auto& links) {
            if constexpr (std::is_same_v<decltype(links), std::vector<std::decay_t<decltype(link)>>&>)
              links.push_back(link);
          });
        },
        draftLink.link);
  }
}

}  // namespace cradle

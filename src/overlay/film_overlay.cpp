// Overlays lie on the picture: marks of what is inside or behind bodies (contact points, centres of mass) would be
// hidden in it. They are drawn on the finished picture, so that the picture beneath is drawn as it would be without
// them.

#include "overlay/film_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/font.h"
#include "overlay/time_panel.h"

namespace cradle {
namespace {

// Of the film, as its viewer sees it.
constexpr double kTrailSeconds = 1.2, kContactSeconds = 0.25;
constexpr long kMaxTrailPoints = 120;
constexpr double kSmoothTurn = 0.7;  // change of velocity between frames, of the velocity: below, no impact
// Of arrowUnit().
constexpr double kLongestVelocity = 0.22, kLongestImpulse = 0.14, kLongestForce = 0.14;
// Of the picture's height.
constexpr double kTrailWidth = 0.008, kArrowWidth = 0.0075, kDotRadius = 0.006, kLoadText = 0.028;
constexpr double kPanelGap = 0.015;       // between time and plot, of the picture's height
constexpr double kMinMark = 0.35;         // of an impact or force, in terms of that of the film's greatest
constexpr std::size_t kMaxLoadTexts = 4;  // the greatest ones of a picture: more would hide each other
constexpr double kShortestText = 0.05;    // of the film's greatest impulse or force: below, a number says nothing
const Ink kVelocity{{0, 128, 96}, 1}, kImpulse{{200, 16, 46}, 1}, kForce{{20, 70, 200}, 1};
const Ink kLabelPanel{{18, 22, 30}, 0.88}, kLabelWords{{255, 255, 255}, 1}, kHalo{{255, 255, 255}, 0.7};
// Colours that people with any colour vision tell apart (M. Okabe, K. Ito, "Color Universal Design", 2008).
const std::array<Ink, 6> kTrailInks = {Ink{{0, 114, 178}},   Ink{{230, 159, 0}},  Ink{{120, 94, 240}},
                                       Ink{{204, 121, 167}}, Ink{{86, 180, 233}}, Ink{{70, 70, 70}}};
const Ink kFirstCurve{{86, 180, 233}, 1}, kSecondCurve{{255, 176, 64}, 1}, kSumCurve{{255, 255, 255}, 1};

constexpr std::array<PlotCorner, 3> kCorners = {PlotCorner::upperRight, PlotCorner::lowerRight, PlotCorner::lowerLeft};

/// What arrows are measured by (m): the size of what the film shows, or as much of it as the cameras that the scene
/// names see at once.
double arrowUnit(const View& view) {
  double unit = view.bounds.isEmpty() ? std::numeric_limits<double>::infinity() : view.size();
  const auto include = [&unit](const Camera& camera) {
    const double distance = (camera.target - camera.position).norm();
    unit = std::min(unit, 2 * std::tan(camera.verticalFieldOfView / 2) * distance);
  };
  include(view.camera);
  for (const Camera& camera : view.keys) include(camera);
  return unit;
}

/// Where a plot in the upper right corner begins (pixels): below a panel with that lower right end if it would lie on
/// it.
double upperEdgeBeside(const PicturePoint& end, int width, int height) {
  const double gap = kPanelGap * height;
  const bool isBeside = plotPanelAt(PlotCorner::upperRight, 0, width, height).first.x >= end.x + gap;
  return isBeside ? 0 : end.y + gap;
}

struct TimedPoint {
  double time;  // s
  Vec3 point;   // m, world
};

/// A body's centre of mass between two frames: on a cubic with their velocities if that departs little from the
/// straight way, on that if an impact lies between.
TimedPoint between(const Frame& before, const Frame& after, std::size_t body, double share) {
  const BodyState &a = before.states[body], &b = after.states[body];
  const double span = after.time - before.time;
  const Vec3 way = b.position - a.position;
  const Vec3 bend =
      share * (1 - share) * ((1 - share) * (span * a.linearVelocity - way) - share * (span * b.linearVelocity - way));
  const bool isSmooth = span * (b.linearVelocity - a.linearVelocity).norm() < kSmoothTurn * way.norm();
  return {before.time + share * span, a.position + share * way + (isSmooth ? bend : Vec3(Vec3::Zero()))};
}

}  // namespace

FilmOverlay::FilmOverlay(const FilmRecord& film, const OverlayChoice& choice)
    : scene_(film.scene),
      choice_(choice),
      view_(film.view),
      frameAt_(film.frameAt),
      contactsAt_(film.contactsAt),
      horizon_(film.horizon),
      camera_(scene_, view_.camera, frameAt_) {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
    if (scene_.bodies[i].motion != Motion::fixed) movingBodies_.push_back(static_cast<int>(i));
  for (const Event& event : film.events)
    if (event.kind == EventKind::impact && event.impulse > 0) impacts_.push_back(event);
  for (const Event& event : impacts_) greatestImpulse_ = std::max(greatestImpulse_, event.impulse);
  for (long number = 0; choice_.contacts && number < film.frameCount; ++number)
    for (const ContactWrench& wrench : contactsAt_(number))
      greatestForce_ = std::max(greatestForce_, wrench.force.norm());
  arrowUnit_ = arrowUnit(view_);
  const double perSecond = scene_.output.framesPerSecond;
  trailStride_ = std::max(1L, static_cast<long>(std::ceil(kTrailSeconds * perSecond / kMaxTrailPoints)));
  if (choice_.velocities || choice_.plot) readFilm(film);
}

void FilmOverlay::readFilm(const FilmRecord& film) {
  if (choice_.plot == PlotKind::energy)
    plot_ = {"energy (J)", {}, {{"kinetic", {}, kFirstCurve}, {"potential", {}, kSecondCurve}, {"sum", {}, kSumCurve}}};
  if (choice_.plot == PlotKind::energyError) plot_ = {"energy error (J)", {}, {{"", {}, kSecondCurve}}};
  if (choice_.plot == PlotKind::height) {
    plottedBody_ = plottedBody(choice_, scene_);
    plot_ = {"height of " + choice_.plottedBody + " (m)", {}, {{"", {}, kFirstCurve}}};
  }
  if (choice_.time)
    plot_.upperEdge = upperEdgeBeside(timePanelEnd(scene_, horizon_, film.width, film.height), film.width, film.height);
  std::array<long, kCorners.size()> hidden{};
  for (long number = 0; number < film.frameCount; ++number) {
    const Frame frame = film.frameAt(number);
    for (const BodyState& state : frame.states) greatestSpeed_ = std::max(greatestSpeed_, state.linearVelocity.norm());
    if (!choice_.plot) continue;
    addToPlot(frame);
    countHidden(frame, {camera_.at(frame), film.width, film.height}, hidden);
  }
  const bool hasLowerText = std::any_of(scene_.captions.begin(), scene_.captions.end(),
                                        [](const Caption& caption) { return caption.body == kWorld; });
  const auto corners = hasLowerText ? hidden.begin() + 1 : hidden.end();  // the upper one first
  plot_.corner = kCorners[static_cast<std::size_t>(std::min_element(hidden.begin(), corners) - hidden.begin())];
  if (choice_.plot != PlotKind::energy) return;
  // A potential's zero means nothing: from its lowest, so that curves of one size share the plot.
  auto& potential = plot_.curves[1].values;
  const double lowest = *std::min_element(potential.begin(), potential.end());
  for (double& value : potential) value -= lowest;
  for (double& value : plot_.curves[2].values) value -= lowest;
}

/// Adds up by corner how many bodies a plot would hide.
void FilmOverlay::countHidden(const Frame& frame, const Lens& lens, std::array<long, 3>& hidden) const {
  for (const BodyState& state : frame.states) {
    const auto place = lens.see(state.position);
    for (std::size_t i = 0; i < kCorners.size() && place; ++i) {
      const auto [low, high] = plotPanelAt(kCorners[i], plot_.upperEdge, lens.width, lens.height);
      hidden[i] += place->x > low.x && place->x < high.x && place->y > low.y && place->y < high.y;
    }
  }
}

void FilmOverlay::addToPlot(const Frame& frame) {
  const EnergyBalance& energy = frame.energy;
  plot_.times.push_back(frame.time);
  if (choice_.plot == PlotKind::energy) {
    plot_.curves[0].values.push_back(energy.kinetic);
    plot_.curves[1].values.push_back(energy.potential);
    plot_.curves[2].values.push_back(energy.kinetic + energy.potential);
  } else if (choice_.plot == PlotKind::energyError) {
    const double sum = energy.kinetic + energy.potential + energy.dissipated - energy.work;
    auto& values = plot_.curves[0].values;
    if (values.empty()) energyAtStart_ = sum;
    values.push_back(sum - energyAtStart_);
  } else {
    const auto state = std::find(movingBodies_.begin(), movingBodies_.end(), plottedBody_);
    const auto index = static_cast<std::size_t>(state - movingBodies_.begin());
    plot_.curves[0].values.push_back(frame.states.at(index).position.y());
  }
}

void FilmOverlay::draw(const Frame& frame, Image& image) {
  const Lens lens{camera_.at(frame), image.width, image.height};
  Canvas canvas(image);
  if (choice_.trails) drawTrails(frame, lens, canvas);
  if (choice_.velocities) drawVelocities(frame, lens, canvas);
  if (choice_.contacts) drawContacts(frame, lens, canvas);
  if (choice_.plot) drawPlot(canvas, plot_, static_cast<std::size_t>(frame.number));
  if (choice_.time) drawTimePanel(canvas, scene_, horizon_, frame.time);
}

std::vector<PicturePart> FilmOverlay::upperPanels(int width, int height) const {
  std::vector<PicturePart> panels;
  if (choice_.time) {
    const PicturePoint end = timePanelEnd(scene_, horizon_, width, height);
    panels.push_back({0, 0, end.x, end.y});
  }
  if (choice_.plot && plot_.corner == PlotCorner::upperRight) {
    const auto [low, high] = plotPanelAt(plot_.corner, plot_.upperEdge, width, height);
    panels.push_back({low.x, low.y, high.x, high.y});
  }
  return panels;
}

/// Brings the frames that end at `now` into trailFrames_, reading those that are not there.
void FilmOverlay::readTrail(long now) {
  const double perSecond = scene_.output.framesPerSecond;
  const long length = static_cast<long>(kTrailSeconds * perSecond);
  const long first = (std::max(now - length, 0L) + trailStride_ - 1) / trailStride_ * trailStride_;
  while (!trailFrames_.empty() && trailFrames_.front().number < first) trailFrames_.pop_front();
  while (!trailFrames_.empty() && trailFrames_.back().number >= now) trailFrames_.pop_back();
  if (!trailFrames_.empty() && trailFrames_.front().number > first) trailFrames_.clear();
  for (long next = trailFrames_.empty() ? first : trailFrames_.back().number + trailStride_; next < now;
       next += trailStride_)
    trailFrames_.push_back(frameAt_(next));
}

/// Thinner and fainter the older they are. A frame of a trail is kept from when it is drawn.
void FilmOverlay::drawTrails(const Frame& frame, const Lens& lens, Canvas& canvas) {
  readTrail(frame.number);
  const double width = kTrailWidth * lens.height, span = kTrailSeconds * scene_.output.playbackSpeed;
  for (std::size_t body = 0; body < frame.states.size(); ++body) {
    std::vector<LinePoint> line;
    const auto add = [&](const TimedPoint& at) {
      const double freshness = std::clamp(1 - (frame.time - at.time) / span, 0.0, 1.0);
      if (const auto place = lens.see(at.point)) line.push_back({*place, width * (0.25 + 0.75 * freshness), freshness});
    };
    for (std::size_t i = 0; i < trailFrames_.size(); ++i) {
      const Frame& after = i + 1 < trailFrames_.size() ? trailFrames_[i + 1] : frame;
      for (const double share : {0.0, 0.25, 0.5, 0.75}) add(between(trailFrames_[i], after, body, share));
    }
    add({frame.time, frame.states[body].position});
    std::vector<LinePoint> halo = line;
    for (LinePoint& point : halo) point.width *= 1.7;
    canvas.line(halo, kHalo);
    canvas.line(line, kTrailInks[body % kTrailInks.size()]);
  }
  if (frame.number % trailStride_ == 0) trailFrames_.push_back(frame);
}

/// From the centre of mass; lengths go with the speed, the film's greatest being the longest.
void FilmOverlay::drawVelocities(const Frame& frame, const Lens& lens, Canvas& canvas) const {
  if (greatestSpeed_ == 0) return;
  const double metresPerSpeed = kLongestVelocity * arrowUnit_ / greatestSpeed_;
  for (const BodyState& state : frame.states) {
    const auto tail = lens.see(state.position);
    const auto tip = lens.see(state.position + metresPerSpeed * state.linearVelocity);
    if (tail && tip) drawArrow(canvas, *tail, *tip, kArrowWidth * lens.height, kVelocity);
  }
}

void FilmOverlay::drawContacts(const Frame& frame, const Lens& lens, Canvas& canvas) const {
  std::vector<LoadText> texts;
  drawForces(frame, lens, canvas, texts);
  drawImpacts(frame, lens, canvas, texts);
  drawLoadTexts(std::move(texts), canvas);
}

/// An arrow from where bodies press each other, on each of them that moves: the force on it. Lengths go with the root
/// of the force, as those of impacts.
void FilmOverlay::drawForces(const Frame& frame, const Lens& lens, Canvas& canvas, std::vector<LoadText>& texts) const {
  for (const ContactWrench& wrench : contactsAt_(frame.number)) {
    const auto point = lens.see(wrench.point);
    const double force = wrench.force.norm();
    if (!point || !(force > 0)) continue;
    const double size = std::sqrt(force / greatestForce_), length = kLongestForce * arrowUnit_ * size;
    const double scale = kMinMark + (1 - kMinMark) * size;
    const auto draw = [&](int body, double way) {
      if (scene_.bodies[static_cast<std::size_t>(body)].motion == Motion::fixed) return;
      if (const auto tip = lens.see(wrench.point + way * length / force * wrench.force))
        drawArrow(canvas, *point, *tip, scale * kArrowWidth * lens.height, kForce);
    };
    draw(wrench.bodyA, -1), draw(wrench.bodyB, 1);
    const double radius = scale * kDotRadius * lens.height;
    canvas.disc(*point, 1.5 * radius, {{255, 255, 255}, 1});
    canvas.disc(*point, radius, kForce);
    if (force >= kShortestText * greatestForce_) texts.push_back({fmt::format("{:.3g} N", force), size, *point, 1});
  }
}

/// A dot where bodies met, and an arrow to either side: what each gave the other. Lengths go with the root of the
/// impulse, which spans decades.
void FilmOverlay::drawImpacts(const Frame& frame, const Lens& lens, Canvas& canvas,
                              std::vector<LoadText>& texts) const {
  const double shown = kContactSeconds * scene_.output.playbackSpeed;
  auto next = std::partition_point(impacts_.begin(), impacts_.end(),
                                   [&](const Event& event) { return event.time <= frame.time - shown; });
  for (; next != impacts_.end() && next->time <= frame.time; ++next) {
    const Event& event = *next;
    const auto point = lens.see(event.point);
    if (!point) continue;
    const double opacity = 1 - (frame.time - event.time) / shown;
    const double size = std::sqrt(event.impulse / greatestImpulse_), length = kLongestImpulse * arrowUnit_ * size;
    const double scale = kMinMark + (1 - kMinMark) * size;  // of lines and dots
    for (const double way : {-1.0, 1.0})
      if (const auto tip = lens.see(event.point + way * length * event.normal))
        drawArrow(canvas, *point, *tip, scale * kArrowWidth * lens.height, {kImpulse.color, opacity});
    const double radius = scale * kDotRadius * lens.height;
    canvas.disc(*point, 1.5 * radius, {{255, 255, 255}, opacity * opacity});
    canvas.disc(*point, radius, {kImpulse.color, opacity});
    if (event.impulse >= kShortestText * greatestImpulse_)
      texts.push_back({fmt::format("{:.3g} N s", event.impulse), size, *point, opacity});
  }
}

/// The greatest first; none where another one stands.
void FilmOverlay::drawLoadTexts(std::vector<LoadText> texts, Canvas& canvas) {
  std::stable_sort(texts.begin(), texts.end(), [](const LoadText& a, const LoadText& b) { return a.size > b.size; });
  const TextSize size = crispTextSize(kLoadText * canvas.height());
  const double padding = 0.35 * size.em, lineHeight = size.ascent + 2 * padding;
  std::vector<PicturePoint> starts;
  for (const LoadText& label : texts) {
    if (starts.size() == kMaxLoadTexts) break;
    const double width = textWidth(label.text, size);
    const PicturePoint start{label.point.x - width / 2, label.point.y - 1.6 * size.em};
    const bool isTaken = std::any_of(starts.begin(), starts.end(), [&](const PicturePoint& other) {
      return std::abs(other.y - start.y) < lineHeight && std::abs(other.x - start.x) < width + 2.5 * padding;
    });
    if (isTaken) continue;
    starts.push_back(start);
    canvas.rectangle({start.x - padding, start.y - size.ascent - padding},
                     {start.x + width + padding, start.y + padding}, padding,
                     {kLabelPanel.color, kLabelPanel.opacity * label.opacity});
    drawText(canvas, label.text, size, start, {kLabelWords.color, label.opacity});
  }
}

}  // namespace cradle

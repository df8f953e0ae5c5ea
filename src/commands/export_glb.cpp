#include "commands/export_glb.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

#include "commands/glb_joints.h"
#include "core/crash.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/progress.h"
#include "film/film_source.h"
#include "film/film_view.h"
#include "math/rotation.h"
#include "render/appearance.h"
#include "render/body_place.h"
#include "render/camera.h"
#include "render/link_items.h"
#include "scene/count_bodies.h"

namespace cradle {
namespace {

constexpr double kPlaneOfScene = 4;  // width of a plane, in diagonals of the box around all bodies
constexpr int kLinkFacets = 16;
constexpr double kRounding = 1e-7;  // of a body's size: a centre of mass so near to the origin is there, in 32 bits

/// Arrays of what moves a node, an entry a frame.
struct Track {
  int translation = 0, rotation = 0, scale = 0;
  Quat last = Quat::Identity();  // in the frame before
};

/// A spring, rod or rope.
struct Link {
  const Anchor &anchorA, &anchorB;
  Track track;
};

/// A square of width 1 that faces Y.
DrawnMesh square() {
  DrawnMesh mesh;
  mesh.vertices = {{-0.5, 0, -0.5}, {-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0, -0.5}};
  mesh.normals.assign(4, Vec3f::UnitY());
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

RigidTransform poseOf(const Camera& camera) {
  return {Quat(cameraAxes(camera)), camera.position};
}

class GlbExport {
 public:
  /// `motion` has a whole trajectory, and must outlive this object. The y axis of glTF is up, as in pictures.
  GlbExport(FilmSource& motion, const std::string& path)
      : motion_(motion),
        reader_(motion.reader()),
        path_(path),
        scene_(motion.drawnScene()),
        file_(scene_.name),
        meshes_(reader_.header(), scene_, file_) {}

  void build(bool quiet);
  void write(PartFile& file) { file_.write(path_, file); }

 private:
  std::size_t frameCount() const { return reader_.frameTimes().size(); }
  void requireFits() const;
  void addTimes();
  void addBodies(const std::vector<RigidTransform>& places);
  template <typename Links>
  void addLinks(const Links& links, const std::string& material, const Surface& surface);
  void addFrame(const Frame& frame);
  void addPlanes();
  void addCamera();
  void followCamera(const Frame& frame);
  void addLights();
  Track addTrack(int node);
  void setPose(std::size_t frame, const Vec3& position, const Quat& orientation, Track& track);
  void setLink(std::size_t frame, const std::vector<RigidTransform>& places, Link& link);

  FilmSource& motion_;
  const TrajectoryReader& reader_;
  const std::string path_;
  const Scene& scene_;
  GlbFile file_;
  GlbMeshes meshes_;
  int times_ = 0;
  std::vector<int> bodyNodes_;
  std::vector<Track> bodyTracks_;  // of bodies that move
  std::vector<Link> links_;
  Bounds bounds_;  // m, world, of bodies at the start, and then of their places
  double linkRadius_ = 0;
  std::optional<GlbJoints> joints_;  // always there once links are
  std::optional<FilmCamera> camera_;
  RigidTransform cameraPose_;
  std::optional<Track> cameraTrack_;  // if it moves
};

/// Before memory is taken. What else is in the file is little, and counted when it is written.
void GlbExport::requireFits() const {
  const std::uint64_t bodies = scene_.bodies.size() - countBodies(scene_, Motion::fixed);
  const std::uint64_t links = scene_.springs.size() + scene_.rods.size() + scene_.ropes.size();
  GlbFile::requireFits(sizeof(float) * frameCount() * (1 + 7 * bodies + 10 * links), path_);
}

void GlbExport::addTimes() {
  const std::vector<double>& times = reader_.frameTimes();
  if (times.empty()) throw Error(ErrorKind::usage, reader_.path(), "has no frames yet");
  times_ = file_.addVectors(times.size(), 1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && static_cast<float>(times[i]) <= static_cast<float>(times[i - 1]))
      throw Error(ErrorKind::usage, reader_.path(),
                  fmt::format("has frames at {} and {} s, which the 32-bit times of a .glb cannot tell apart; export "
                              "FILE.csv, or simulate with fewer frames per second",
                              times[i - 1], times[i]));
    file_.set(times_, i, Eigen::Matrix<double, 1, 1>(times[i]));
  }
}

Track GlbExport::addTrack(int node) {
  Track track;
  track.translation = file_.addVectors(frameCount(), 3);
  track.rotation = file_.addVectors(frameCount(), 4);
  file_.animate(node, "translation", times_, track.translation);
  file_.animate(node, "rotation", times_, track.rotation);
  return track;
}

void GlbExport::addBodies(const std::vector<RigidTransform>& places) {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    bodyNodes_.push_back(GlbFile::kNoParent);
    if (std::holds_alternative<Plane>(body.shape)) continue;
    const Bounds local = localBounds(scene_, body);
    bounds_.extend(transformed(local, places[i]));
    const bool moves = body.motion != Motion::fixed;
    const Vec3 center = moves ? body.massProperties.centerOfMass : Vec3::Zero();
    int node = file_.addNode(body.name, {places[i].rotation, places[i] * center});
    bodyNodes_.back() = node;
    if (moves) bodyTracks_.push_back(addTrack(node));
    if (center.norm() > kRounding * local.diagonal().norm())
      node = file_.addNode(body.name + " shape", {Quat::Identity(), -center}, node);
    file_.setMesh(node, meshes_.ofBody(i));
  }
}

template <typename Links>
void GlbExport::addLinks(const Links& links, const std::string& material, const Surface& surface) {
  if (links.empty()) return;
  const int mesh = meshes_.add(material, tessellate(Cylinder{1, 1}, kLinkFacets), material, surface);
  for (const auto& link : links) {
    const int node = file_.addNode(link.name, {});
    file_.setMesh(node, mesh);
    Track track = addTrack(node);
    track.scale = file_.addVectors(frameCount(), 3);
    file_.animate(node, "scale", times_, track.scale);
    links_.push_back({link.anchorA, link.anchorB, track});
  }
}

/// Of q and -q, the one next to that of the frame before, so that what lies between is the short way.
void GlbExport::setPose(std::size_t frame, const Vec3& position, const Quat& orientation, Track& track) {
  const double sign = track.last.dot(orientation) < 0 ? -1 : 1;
  track.last.coeffs() = sign * orientation.coeffs();
  file_.set(track.translation, frame, position);
  file_.set(track.rotation, frame, track.last.coeffs());
}

/// The unit cylinder between the ends. It turns from frame to frame as little as it can.
void GlbExport::setLink(std::size_t frame, const std::vector<RigidTransform>& places, Link& link) {
  const Vec3 a = worldPoint(link.anchorA, places), b = worldPoint(link.anchorB, places);
  const double length = (a - b).norm();
  const Vec3 axis = link.track.last * Vec3::UnitY();
  const Quat turn = length > 0 ? rotationBetween(axis, a - b) : Quat::Identity();
  setPose(frame, (a + b) / 2, (turn * link.track.last).normalized(), link.track);
  file_.set(link.track.scale, frame, Vec3(linkRadius_, length, linkRadius_));
}

void GlbExport::addFrame(const Frame& frame) {
  const auto number = static_cast<std::size_t>(frame.number);
  for (std::size_t i = 0; i < bodyTracks_.size(); ++i) {
    const BodyState& state = frame.states.at(i);
    setPose(number, state.position, state.orientation, bodyTracks_[i]);
    bounds_.extend(state.position);
  }
  joints_->follow(frame);
  if (cameraTrack_) followCamera(frame);
  if (links_.empty()) return;
  const std::vector<RigidTransform> places = placeBodies(scene_, frame);
  for (Link& link : links_) setLink(number, places, link);
}

void GlbExport::addPlanes() {
  const double width = bounds_.isEmpty() ? 1 : kPlaneOfScene * bounds_.diagonal().norm();
  DrawnMesh drawn = square();
  for (Vec3& vertex : drawn.vertices) vertex *= width;
  for (const Body& body : scene_.bodies) {
    const Plane* plane = std::get_if<Plane>(&body.shape);
    if (plane == nullptr) continue;
    const Material& material = scene_.materials.at(static_cast<std::size_t>(body.material));
    const Vec3 normal = body.worldFromBody.rotation * plane->normal, point = body.worldFromBody.translation;
    const Vec3 middle = bounds_.isEmpty() ? point : Vec3(bounds_.center());
    const int node = file_.addNode(
        body.name, {rotationBetween(Vec3::UnitY(), normal), middle - normal.dot(middle - point) * normal});
    file_.setMesh(node, meshes_.add("plane", drawn, material.name, surfaceOf(material, {})));
  }
}

/// The one of the pictures: it looks along its -z axis, with y up. It moves where the scene says so.
void GlbExport::addCamera() {
  const Output& output = scene_.output;
  camera_.emplace(cameraOf(motion_, viewOf(motion_, output.width, output.height)));
  const Camera start = camera_->at(motion_.drawnFrameAt(0));
  cameraPose_ = poseOf(start);
  const int node = file_.addNode("camera", cameraPose_);
  file_.setCamera(node, start.verticalFieldOfView, static_cast<double>(output.width) / output.height);
  if (scene_.camera && !scene_.cameraMotion.isNone()) cameraTrack_ = addTrack(node);
}

/// A camera that comes to be inside of a body, which no picture is seen from, stays where it was.
void GlbExport::followCamera(const Frame& frame) {
  try {
    cameraPose_ = poseOf(camera_->at(frame));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::scene) throw;
  }
  setPose(static_cast<std::size_t>(frame.number), cameraPose_.translation, cameraPose_.rotation, *cameraTrack_);
}

/// They shine along their -z axes.
void GlbExport::addLights() {
  for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
    const Light& light = scene_.lights[i];
    const int node =
        file_.addNode(fmt::format("light{}", i), {rotationBetween(-Vec3::UnitZ(), light.direction), Vec3::Zero()});
    file_.setLight(node, linearFromSrgb(light.color), light.intensity);
  }
}

void GlbExport::build(bool quiet) {
  requireFits();
  addTimes();
  addBodies(placeBodies(scene_, motion_.drawnFrameAt(0)));
  linkRadius_ = linkRadius(scene_, bounds_);
  addLinks(scene_.springs, "spring", kDarkSteel);
  addLinks(scene_.rods, "rod", kSteel);
  addLinks(scene_.ropes, "rope", kHemp);
  joints_.emplace(scene_, bodyNodes_, linkRadius_, file_, meshes_);
  joints_->add();
  addCamera();
  addLights();

  Progress progress("Exporting", "frames", reader_.frameCount(), quiet);
  for (long number = 0; number < reader_.frameCount(); ++number) {
    throwIfInterrupted();
    addFrame(motion_.drawnFrameAt(number));
    progress.update(number + 1);
  }
  joints_->addRails();
  addPlanes();
}

}  // namespace

void exportGlb(TrajectoryReader reader, const std::string& path, bool quiet) {
  PartFile file(path);
  const EndWithoutMemory end;  // nlohmann's documents ask for memory when they go
  FilmSource motion(std::move(reader));
  GlbExport glb(motion, path);
  glb.build(quiet);
  glb.write(file);
  file.complete();
}

}  // namespace cradle

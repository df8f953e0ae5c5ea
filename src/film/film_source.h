#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The scene as a trajectory holds it: its text, with the meshes of the file. Throws Error(usage) if it cannot be read,
/// or has other bodies than the file.
Scene sceneOf(const TrajectoryReader& trajectory);

/// A motion and its scene as pictures show them: those of a trajectory; or of a simulation, where a class derived from
/// this one tells the frames.
class FilmSource {
 public:
  /// Throws as sceneOf does.
  explicit FilmSource(std::shared_ptr<const TrajectoryReader> trajectory);
  explicit FilmSource(TrajectoryReader trajectory)
      : FilmSource(std::make_shared<const TrajectoryReader>(std::move(trajectory))) {}
  virtual ~FilmSource() = default;
  FilmSource(const FilmSource&) = delete;
  FilmSource& operator=(const FilmSource&) = delete;

  const Scene& scene() const { return scene_; }

  /// Scene, frames and events as pictures show them: turned so that y is up.
  const Scene& drawnScene() const { return upright_ ? upright_->scene : scene_; }
  Quat worldFromDrawn() const { return upright_ ? upright_->fromWorld.conjugate() : Quat::Identity(); }
  Frame drawnFrameAt(long number);
  std::vector<Event> drawnPushEvents();
  std::vector<Event> drawnEvents() const;                         // of a whole trajectory
  std::vector<ContactWrench> drawnContactsAt(long number) const;  // the same

  /// Known before the simulation, too.
  long frameCount() const { return frameCount_; }

  /// Throws what reading throws, or simulating.
  virtual Frame frameAt(long number);

  /// The frames before are not asked for again.
  virtual void forgetBefore(long /*number*/) {}

  /// The events of pushes that began or missed their bodies, perhaps among others.
  virtual std::vector<Event> pushEvents();

  /// Needs a whole trajectory.
  const TrajectoryReader& reader() const { return *reader_; }
  bool isWhole() const { return reader_ != nullptr; }

  /// Number of pictures: frames 0..N-1, at least one.
  long pictureCount() const;

 protected:
  FilmSource() = default;
  void setTrajectory(std::shared_ptr<const TrajectoryReader> trajectory);
  /// Of a motion without a trajectory; it has frames 0..lastFrame(scene).
  void setScene(Scene scene);

 private:
  struct Upright {
    Quat fromWorld;
    Scene scene;
  };
  std::vector<Event> drawn(std::vector<Event> events) const;

  std::shared_ptr<const TrajectoryReader> reader_;
  Scene scene_;
  std::optional<Upright> upright_;  // if gravity is along another axis
  long frameCount_ = 0;
};

}  // namespace cradle

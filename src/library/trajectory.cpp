#include <cradle/trajectory.h>
#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "core/output_path.h"
#include "library/scene_content.h"
#include "library/trajectory_content.h"
#include "library/translated.h"
#include "trajectory/copy_trajectory.h"

namespace cradle::v1 {
namespace {

EnergyBalance balanceOf(const cradle::EnergyBalance& energy) {
  return {energy.kinetic,           energy.potential,
          energy.dissipated,        energy.impact,
          energy.friction,          energy.damping,
          energy.numerical,         energy.work,
          arrayOf(energy.momentum), arrayOf(energy.angularMomentum)};
}

ContactForce forceOf(const ContactWrench& wrench) {
  return {
      wrench.contact,         wrench.bodyA,         wrench.bodyB, arrayOf(wrench.force), arrayOf(wrench.normalForce),
      arrayOf(wrench.torque), arrayOf(wrench.point)};
}

}  // namespace

Frame frameOf(const cradle::Frame& frame) {
  Frame told{frame.number, frame.time, {}, balanceOf(frame.energy), {}, {}};
  told.states.reserve(frame.states.size());
  for (const cradle::BodyState& state : frame.states)
    told.states.push_back({arrayOf(state.position), arrayOf(state.orientation), arrayOf(state.linearVelocity),
                           arrayOf(state.angularVelocity)});
  for (const cradle::JointState& joint : frame.joints)
    told.joints.push_back({joint.coordinate, joint.velocity, joint.force});
  for (const ContactWrench& wrench : frame.contacts) told.contacts.push_back(forceOf(wrench));
  return told;
}

Event eventOf(const cradle::Event& event) {
  return {event.time,           eventKindName(event.kind), event.bodyA,  event.bodyB,
          arrayOf(event.point), arrayOf(event.normal),     event.impulse};
}

void requireFrame(const TrajectoryReader& reader, long number) {
  if (number < 0 || number >= reader.frameCount())
    throw Error(ErrorKind::usage,
                fmt::format("frame {}: the trajectory has frames 0 to {}", number, reader.frameCount() - 1));
}

Trajectory Trajectory::open(const std::string& path) {
  return translated(
      [&] { return Trajectory(std::make_shared<Content>(Content{std::make_shared<const TrajectoryReader>(path)})); });
}

const std::string& Trajectory::sceneText() const {
  return content_->reader->header().scene;
}

std::vector<std::string> Trajectory::bodies() const {
  std::vector<std::string> names;
  for (const BodyRecord& body : content_->reader->header().bodies) names.push_back(body.name);
  return names;
}

std::vector<int> Trajectory::movingBodies() const {
  std::vector<int> moving;
  const std::vector<BodyRecord>& bodies = content_->reader->header().bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].hasStates()) moving.push_back(static_cast<int>(i));
  return moving;
}

std::vector<std::string> Trajectory::joints() const {
  std::vector<std::string> names;
  for (const JointRecord& joint : content_->reader->header().joints) names.push_back(joint.name);
  return names;
}

const std::vector<double>& Trajectory::times() const {
  return content_->reader->frameTimes();
}

Frame Trajectory::frame(long number) const {
  requireFrame(*content_->reader, number);
  return translated([&] {
    cradle::Frame frame = content_->reader->readFrame(number);
    frame.contacts = content_->reader->contactsAt(number);
    return frameOf(frame);
  });
}

std::vector<Event> Trajectory::events() const {
  return translated([&] {
    std::vector<Event> events;
    for (const cradle::Event& event : content_->reader->events()) events.push_back(eventOf(event));
    return events;
  });
}

std::optional<double> Trajectory::horizon() const {
  return translated([&] { return content_->reader->horizon(); });
}

const std::map<std::string, std::string>& Trajectory::meta() const {
  return content_->reader->meta();
}

void Trajectory::save(const std::string& path) const {
  translated([&] {
    if (!content_->reader->isFinished())
      throw cradle::Error(
          cradle::ErrorKind::usage, content_->reader->path(),
          "is the trajectory of a run that has not ended; only whole ones are saved under another name");
    requireNoOtherFile(path);
    if (std::filesystem::exists(partPath(path)))
      throw cradle::Error(cradle::ErrorKind::output, partPath(path),
                          "is the unfinished trajectory of a run; go on with it, remove it, or choose another name");
    copyTrajectory(*content_->reader, path);
  });
}

}  // namespace cradle::v1

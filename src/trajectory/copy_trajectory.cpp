#include "trajectory/copy_trajectory.h"

#include "core/interruption.h"

namespace cradle {

void copyTrajectory(const TrajectoryReader& trajectory, const std::string& path) {
  TrajectoryWriter writer(path, trajectory.header());
  for (const LastingContact& contact : trajectory.contacts()) writer.append(contact);
  for (long number = 0; number < trajectory.frameCount(); ++number) {
    throwIfInterrupted();
    Frame frame = trajectory.readFrame(number);
    frame.contacts = trajectory.contactsAt(number);
    writer.append(frame);
  }
  for (const Event& event : trajectory.events()) writer.append(event);
  for (const CameraPose& camera : trajectory.cameras()) writer.append(camera);
  writer.finishAs(trajectory);
}

}  // namespace cradle

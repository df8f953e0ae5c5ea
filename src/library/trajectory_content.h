#pragma once

#include <cradle/trajectory.h>

#include <memory>

#include "trajectory/trajectory_file.h"

namespace cradle::v1 {

struct Trajectory::Content {
  std::shared_ptr<const TrajectoryReader> reader;
};

Frame frameOf(const cradle::Frame& frame);
Event eventOf(const cradle::Event& event);

/// Throws Error(usage) if the trajectory has no frame of that number.
void requireFrame(const TrajectoryReader& reader, long number);

}  // namespace cradle::v1

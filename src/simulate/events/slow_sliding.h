#pragma once

#include "simulate/events/contact_record.h"
#include "simulate/island_state.h"

namespace cradle {

constexpr const char* kSlidesTooSlowly = "contacts slide so slowly that their friction has no sure direction";

/// Whether a contact slides, and goes on sliding, so slowly that errors of velocities decide the direction of its
/// friction, or that following it costs too many steps. `acceleration` is that of the sliding, `largest` the largest at
/// contacts (m/s^2).
bool slidesTooSlowly(const ContactRecord& record, double acceleration, double largest, const IslandState& island);

/// Whether sliding at `speed` (m/s) under the normal force `normal` (N) has its direction turned so fast by friction
/// that steps can hardly follow.
bool isDirectionTurnedFast(const ContactRecord& record, double speed, double normal);

}  // namespace cradle

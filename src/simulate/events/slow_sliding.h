#pragma once

#include "simulate/events/contact_record.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/island_state.h"

namespace cradle {

constexpr const char* kSlidesTooSlowly = "contacts slide so slowly that their friction has no sure direction";

struct SlidingAccelerations {
  double sliding = 0;  // m/s^2, of the surfaces along each other, at a contact
  double largest = 0;  // m/s^2, at all contacts
  double change = 0;   // m/s^3, rate of `sliding`
};

/// Whether a contact slides, and goes on sliding, so slowly that errors of velocities decide the direction of its
/// friction, or that following it costs too many steps.
bool slidesTooSlowly(const ContactRecord& record, const SlidingAccelerations& accelerations,
                     const EventTolerances& tolerances, const IslandState& island);

/// s: how long the friction of a contact that begins to slide so slowly may keep its direction.
double timeOfKeptDirection(const SlidingAccelerations& accelerations, const EventTolerances& tolerances);

/// How many steps follow the friction of such a contact, from then on.
double stepsAfterKeptDirection(const ContactRecord& record, double time, const EventTolerances& tolerances);

/// Whether sliding at `speed` (m/s) under the normal force `normal` (N) has its direction turned so fast by friction
/// that steps can hardly follow.
bool isDirectionTurnedFast(const ContactRecord& record, double speed, double normal);

}  // namespace cradle

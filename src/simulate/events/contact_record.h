#pragma once

#include <string_view>
#include <vector>

#include "collision/separation.h"
#include "simulate/assembly.h"
#include "simulate/resting_bodies.h"

namespace cradle {

/// A contact that touches and carries nothing, beside others of its pair that hold it: if they gave way in proportion
/// to their forces, it would be as far apart as the sum of `parts` times their forces is below zero.
struct IdleContact {
  std::vector<std::pair<std::size_t, double>> parts;  // of active contacts, by their index
};

/// A contact whose bodies touch: how it moves and what it carries, as Coulomb's law on accelerations decides.
struct ContactRecord {
  Contact contact;  // at the instant of classification
  ColliderPair pair;
  bool slides = false;
  bool slips = false;             // it begins to slide: its friction is dynamic, against whatever way it is accelerated
  Vec3 direction = Vec3::Zero();  // unit, world, of A's sliding relative to B; zero unless it slides
  // s: friction is against `direction`, however the contact slides; that turns at the rate (1/s, world, or B's frame)
  double keepsDirectionUntil = 0;
  Vec3 directionRate = Vec3::Zero();
  bool isLoaded = false;  // its normal force is above rounding: it is active
  bool sticks = false;
  bool opens = false;                  // it carries nothing, and the accelerations open it
  bool isRedundant = false;            // statically indeterminate: its forces are not unique
  bool sharesLoads = false;            // with all that depend on each other with it (shareLoads)
  double mass = 1;                     // kg, effective mass along the normal: 1 / W_nn
  double force = 1;                    // N, the unit of its event functions
  std::vector<IdleContact> idle = {};  // those whose sums begin with its force
};

/// Why contacts cannot be rows of the equations of motion, so that time stepping has to take over.
struct ContactFallback {
  std::string_view reason;  // empty: there is none
  std::vector<int> bodies;  // of the scene, ascending
};

/// The reason with the scene bodies of these contacts. Bodies are named at once: a pair may be gone when it is told.
ContactFallback fallbackAt(std::string_view reason, const std::vector<const Contact*>& contacts,
                           const Assembly& assembly);

/// The reason that friction jams (P. Painleve, 1895) at those of the contacts that slide with friction; none without
/// one.
ContactFallback jamAt(const std::vector<const ContactRecord*>& records, const Assembly& assembly);

/// Scene bodies of some contacts, ascending, each once.
std::vector<int> sceneBodiesOf(const std::vector<const Contact*>& contacts, const Assembly& assembly);

/// Whether two pairs are of the same colliders.
bool isSamePair(const ColliderPair& one, const ColliderPair& other);

/// Whether a body at the contact moves and does not rest.
bool isAwake(const Contact& contact, const RestingBodies& resting);

}  // namespace cradle

#pragma once

#include <string>
#include <utility>

#include "collision/separation.h"
#include "experiments/experiment.h"
#include "simulate/island_state.h"

namespace cradle {

/// A scene whose moving bodies are one island, for units that work on that.
struct OneIsland {
  explicit OneIsland(const std::string& members) : OneIsland(sceneWith(members)) {}
  explicit OneIsland(Scene source) : scene(std::move(source)), island(scene, assemble(scene, wholeScene(scene))) {}

  Mechanism& mechanism() { return island.assembly.mechanism; }
  VectorX& state() { return island.state; }

  /// Contacts of now with separation <= margin (m).
  std::vector<Contact> contactsWithin(double margin) {
    island.findNearPairsNow(margin);
    std::vector<Contact> contacts;
    findContacts(island.assembly.geometry, island.state, margin, contacts);
    return contacts;
  }

  Scene scene;
  IslandState island;
};

/// The inertia tensor (kg m^2, world, about the centre of mass) of a body in a state.
inline Mat3 worldInertia(const RigidBody& body, int index, const VectorX& state) {
  const Mat3 turn = orientation(state, index).normalized().toRotationMatrix();
  return turn * body.inertiaTensor * turn.transpose();
}

}  // namespace cradle

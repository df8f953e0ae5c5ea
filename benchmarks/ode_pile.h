#pragma once

#include <ode/ode.h>

#include <vector>

#include "pile_scene.h"

namespace cradle {

/// A heap in ODE, as its guide advises for many bodies: dWorldQuickStep with 20 iterations, a hash space, bodies that
/// lie still are disabled.
class OdePile {
 public:
  explicit OdePile(const PileScene& scene);
  ~OdePile();
  OdePile(const OdePile&) = delete;
  OdePile& operator=(const OdePile&) = delete;

  void advance();
  bool isAtRest() const;
  PilePoses poses() const;

 private:
  void add(const PileItem& item);
  void addContacts(dGeomID a, dGeomID b);

  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dBodyID> bodies_;
};

}  // namespace cradle

#pragma once

#include <optional>

#include "simulate/spheres/sphere_flights.h"
#include "simulate/spheres/sphere_tolerances.h"

namespace cradle {

/// What happens where spheres touch: lossless impacts of all that touch each other at an instant, and planes that carry
/// spheres.
class SphereImpact {
 public:
  /// Keeps references to both.
  SphereImpact(const SphereWorld& world, SphereFlights& flights) : world_(world), flights_(flights) {}

  /// Finds the spheres that planes carry at time 0.
  void begin();

  /// Reflects a contact that closes at `time` (s), and all contacts that touch it, directly or by way of others.
  void resolve(int sphere, int other, double time);

  /// The spheres that the last call struck, ascending; its contacts and what they got (N s).
  const std::vector<int>& spheres() const { return spheres_; }
  const std::vector<SphereContact>& contacts() const { return contacts_; }
  const std::vector<double>& impulses() const { return impulses_; }

  /// What its impulses took of the energy (J), and what rounding and planes that stop slow spheres took beside them.
  double energyTaken() const { return energyTaken_; }
  double energyLost() const { return energyLost_; }

  /// A contact of the last call that would last under load, and is none with a plane: no parabola is its motion.
  std::optional<SphereContact> lastingContact() const;

 private:
  void findTouching(int sphere, int other, double time);
  void keepContact(const SphereContact& contact);
  void moveHere(double time);
  void reflectAlone(std::size_t contact);
  bool reflectAll();
  double kineticEnergy() const;
  VectorX openingSpeeds() const;
  void findSupports();
  void carry(std::size_t index, const std::vector<int>& planes);
  bool isSlow(const SphereContact& contact, double speed) const;
  SphereTolerances tolerances() const { return {world_.gravity.norm()}; }
  Vec3 relativeVelocity(const SphereContact& contact) const;
  std::size_t indexOf(int sphere) const;
  double inverseMassOf(int sphere) const {
    return sphere < 0 ? 0 : world_.inverseMasses[static_cast<std::size_t>(sphere)];
  }

  const SphereWorld& world_;
  SphereFlights& flights_;
  std::vector<int> spheres_;
  std::vector<SphereContact> contacts_, found_;
  std::vector<double> impulses_;
  double energyTaken_ = 0, energyLost_ = 0;   // J
  std::vector<UniformMotion> motions_;        // by place in spheres_
  std::vector<std::array<int, 3>> supports_;  // the same
};

}  // namespace cradle

#pragma once

#include <optional>

#include "simulate/balls/ball_flights.h"

namespace cradle {

/// What happens where balls touch: lossless impacts of all that touch each other at an instant, and planes that carry
/// balls.
class BallImpact {
 public:
  /// Keeps references to both.
  BallImpact(const BallWorld& world, BallFlights& flights) : world_(world), flights_(flights) {}

  /// Finds the balls that planes carry at time 0.
  void begin();

  /// Reflects a contact that closes at `time` (s), and all contacts that touch it, directly or by way of others.
  void resolve(int ball, int other, double time);

  /// The balls that the last call struck, ascending; its contacts and what they got (N s).
  const std::vector<int>& balls() const { return balls_; }
  const std::vector<BallContact>& contacts() const { return contacts_; }
  const std::vector<double>& impulses() const { return impulses_; }

  /// What its impulses took of the energy (J), and what rounding and planes that stop slow balls took beside them.
  double energyTaken() const { return energyTaken_; }
  double energyLost() const { return energyLost_; }

  /// A contact of the last call that would last under load, and is none with a plane: no parabola is its motion.
  std::optional<BallContact> lastingContact() const;

 private:
  void findTouching(int ball, int other, double time);
  void keepContact(const BallContact& contact);
  void moveHere(double time);
  void reflectAlone(std::size_t contact);
  bool reflectAll();
  double kineticEnergy() const;
  VectorX openingSpeeds() const;
  void findSupports();
  void carry(std::size_t index, const std::vector<int>& planes);
  bool isSlow(const BallContact& contact, double speed) const;
  Vec3 relativeVelocity(const BallContact& contact) const;
  std::size_t indexOf(int ball) const;
  double inverseMassOf(int ball) const { return ball < 0 ? 0 : world_.inverseMasses[static_cast<std::size_t>(ball)]; }

  const BallWorld& world_;
  BallFlights& flights_;
  std::vector<int> balls_;
  std::vector<BallContact> contacts_, found_;
  std::vector<double> impulses_;
  double energyTaken_ = 0, energyLost_ = 0;   // J
  std::vector<UniformMotion> motions_;        // by place in balls_
  std::vector<std::array<int, 3>> supports_;  // the same
};

}  // namespace cradle

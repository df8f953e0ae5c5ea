// In place of bullet.cpp in a program without Bullet.

#include "core/error.h"
#include "study/peers/bullet.h"

namespace cradle {

struct BulletWorld::World {};

bool hasBullet() {
  return false;
}

std::string missingInBullet(const Scene&) {
  return "Bullet itself";
}

BulletWorld::BulletWorld(const Scene&, const Assembly&, const BulletSettings&) {
  CRADLE_CHECK(hasBullet());
}
BulletWorld::~BulletWorld() = default;

void BulletWorld::step(double) {}
void BulletWorld::read(VectorX&) const {}

}  // namespace cradle

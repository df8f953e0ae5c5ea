#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "trajectory/trajectory.h"

namespace cradle {

/// 64-bit FNV-1a of a sequence of bytes. Any change of one byte changes it, whatever follows.
class Hash {
 public:
  void add(std::span<const std::byte> bytes);
  std::string hex() const;  // 16 lower-case digits

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;  // FNV offset basis
};

/// The hash of a text's bytes, in hex.
std::string textHash(const std::string& text);

/// Adds a frame: its number (64-bit integer), its time and, body by body, px py pz qw qx qy qz vx vy vz wx wy wz, all
/// as 8 bytes, little-endian. Bits count: -0 and 0 differ. The frames of a trajectory, in order, give its `stateHash`.
void addFrame(const Frame& frame, Hash& hash);

/// The 13 numbers of a state in the order of the trajectory file's columns.
std::array<double, 13> stateNumbers(const BodyState& state);

}  // namespace cradle

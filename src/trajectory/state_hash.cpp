// FNV-1a, 64 bits (G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm").
// Each byte is xor-ed in and the sum multiplied by an odd number, both of which can be undone: two sequences that
// differ in one byte can never meet again. That is what a hash that guards equal bits has to promise; it is no defence
// against forgery.

#include "trajectory/state_hash.h"

#include <fmt/format.h>

#include <array>
#include <bit>

namespace cradle {
namespace {

constexpr std::uint64_t kPrime = 0x100000001b3;  // FNV prime for 64 bits

static_assert(std::endian::native == std::endian::little, "hashes and blobs are little-endian bytes");

}  // namespace

void Hash::add(std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) value_ = (value_ ^ static_cast<std::uint64_t>(byte)) * kPrime;
}

std::string Hash::hex() const {
  return fmt::format("{:016x}", value_);
}

std::string textHash(const std::string& text) {
  Hash hash;
  hash.add(std::as_bytes(std::span(text)));
  return hash.hex();
}

void addFrame(const Frame& frame, Hash& hash) {
  const std::int64_t number = frame.number;
  hash.add(std::as_bytes(std::span(&number, 1)));
  hash.add(std::as_bytes(std::span(&frame.time, 1)));
  for (const BodyState& state : frame.states) {
    const auto numbers = stateNumbers(state);
    hash.add(std::as_bytes(std::span(numbers)));
  }
}

std::array<double, 13> stateNumbers(const BodyState& state) {
  const Vec3 &p = state.position, &v = state.linearVelocity, &w = state.angularVelocity;
  const Quat& q = state.orientation;
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}

}  // namespace cradle

#pragma once

#include <cstdint>
#include <cstring>
#include <string>

// 3ds files chunk by chunk.

namespace cradle {

template <typename T>
void put(std::string& bytes, std::size_t where, T value) {
  std::memcpy(bytes.data() + where, &value, sizeof value);
}

inline std::string appendedToMain(std::string bytes, const std::string& chunk) {
  bytes += chunk;
  put(bytes, 2, static_cast<std::uint32_t>(bytes.size()));
  return bytes;
}

inline std::string chunk(std::uint16_t id, const std::string& data) {
  std::string bytes(6, '\0');
  put(bytes, 0, id);
  put(bytes, 2, static_cast<std::uint32_t>(data.size() + 6));
  return bytes + data;
}

}  // namespace cradle

#pragma once

#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"

// Plain records as bytes of this machine, to be read by the build that wrote them. A record has a function
// visit(archive, record) that calls archive(...) with its members: one and the same for both ways. One of type R takes
// a Visited<Archive, R>&.

namespace cradle {

/// Writes what it is called with.
class ByteWriter {
 public:
  static constexpr bool kReads = false;

  template <class... Values>
  void operator()(const Values&... values) {
    (add(values), ...);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class Value>
  void add(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>)
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else
      visit(*this, value);
  }
  template <class A, class B>
  void add(const std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class Value, std::size_t N>
  void add(const std::array<Value, N>& values) {
    for (const Value& value : values) add(value);
  }
  template <class Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  void add(const std::string& text) { addAll(text); }
  template <class Value>
  void add(const std::vector<Value>& values) {
    addAll(values);
  }
  template <class Key, class Value>
  void add(const std::map<Key, Value>& values) {
    addAll(values);
  }
  template <class Values>
  void addAll(const Values& values) {
    add(values.size());
    for (const auto& value : values) add(value);
  }

  std::string bytes_;
};

/// Reads into what it is called with. Throws Error(output) where bytes end too early.
class ByteReader {
 public:
  static constexpr bool kReads = true;

  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... Values>
  void operator()(Values&... values) {
    (take(values), ...);
  }
  bool isAtEnd() const { return bytes_.empty(); }

 private:
  template <class Value>
  void take(Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      requireBytes(sizeof value);
      std::memcpy(&value, bytes_.data(), sizeof value);
      bytes_.remove_prefix(sizeof value);
    } else {
      visit(*this, value);
    }
  }
  template <class A, class B>
  void take(std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class Value, std::size_t N>
  void take(std::array<Value, N>& values) {
    for (Value& value : values) take(value);
  }
  template <class Value>
  void take(std::optional<Value>& value) {
    bool isThere = false;
    take(isThere);
    value.reset();
    if (isThere) take(value.emplace());
  }
  void take(std::string& text) {
    const std::size_t size = takeSize();
    text = std::string(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
  }
  template <class Value>
  void take(std::vector<Value>& values) {
    values.clear();
    for (std::size_t left = takeSize(); left > 0; --left) take(values.emplace_back());
  }
  template <class Key, class Value>
  void take(std::map<Key, Value>& values) {
    values.clear();
    for (std::size_t left = takeSize(); left > 0; --left) {
      std::pair<Key, Value> value;
      take(value);
      values.insert(std::move(value));
    }
  }
  std::size_t takeSize() {
    std::size_t size = 0;
    take(size);
    requireBytes(size);  // each element has one at least
    return size;
  }
  void requireBytes(std::size_t size) const {
    if (size > bytes_.size()) throw Error(ErrorKind::output, "", "a record of a run is damaged");
  }

  std::string_view bytes_;
};

/// A record that is read, or one that is written.
template <class Archive, class Record>
using Visited = std::conditional_t<Archive::kReads, Record, const Record>;

}  // namespace cradle

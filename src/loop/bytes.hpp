// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "posefusion/core/error.hpp"

namespace pf {

/// Plain numbers one after the other, as little-endian machines hold them (all that ROS runs on).
class ByteWriter {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>, "numbers only");
    append(&value, sizeof value);
  }
  void append(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what a ByteWriter wrote. Throws InputError naming `what` when there is too little, too
/// much or something else.
class ByteReader {
 public:
  ByteReader(const std::string& bytes, const char* what) : bytes_(bytes), what_(what) {}

  template <typename T>
  T get() {
    static_assert(std::is_arithmetic_v<T>, "numbers only");
    T value;
    read(&value, sizeof value);
    return value;
  }
  void read(void* data, std::size_t size) {
    if (size > left()) fail("ends early");
    if (size > 0) std::memcpy(data, bytes_.data() + position_, size);
    position_ += size;
  }
  std::size_t left() const { return bytes_.size() - position_; }

  void expect(std::uint32_t magic, std::uint32_t version) {
    if (get<std::uint32_t>() != magic) fail("is no data of this kind");
    const auto found = get<std::uint32_t>();
    if (found != version) {
      fail("has version " + std::to_string(found) + ", expected " + std::to_string(version));
    }
  }
  void finish() const {
    if (left() != 0) fail("has more bytes than it should");
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(std::string(what_) + ": " + reason);
  }

 private:
  const std::string& bytes_;
  const char* what_;
  std::size_t position_ = 0;
};

}  // namespace pf

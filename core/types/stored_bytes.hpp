#pragma once
/// Values as bytes of this machine, to be kept and read again by the same program: an archive that
/// writes, and one that reads the same calls back. What is read is not trusted: every length is
/// compared with the bytes that are left before anything is allocated.
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// Bytes that are too short, too long, or no sensible value.
struct StoredBytesError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Numbers, enumerators and arrays of them, which go as they lie in memory. Not bool, of which a
/// byte may be neither value, and no structure, whose padding is anything.
template <class T>
concept PlainNumber = (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) || std::is_enum_v<T>;

namespace stored_bytes {
template <class T>
struct IsPlainRow : std::bool_constant<PlainNumber<T>> {};
template <class T, std::size_t N>
struct IsPlainRow<std::array<T, N>> : std::bool_constant<PlainNumber<T>> {};
}  // namespace stored_bytes

/// Appends each value that it is called with.
class ByteWriter {
 public:
  template <PlainNumber T>
  void operator()(const T& value) {
    add(&value, sizeof value);
  }
  void operator()(const bool& value) { (*this)(std::uint8_t{value}); }
  template <int R, int C>
  void operator()(const Eigen::Matrix<double, R, C>& value) {
    add(value.data(), sizeof(double) * R * C);
  }
  void operator()(const std::string& value) { add_row(value.data(), value.size(), 1); }
  template <class T>
  void operator()(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value)
      (*this)(*value);
  }
  template <class T, class Allocator>
  void operator()(const std::vector<T, Allocator>& values) {
    if constexpr (stored_bytes::IsPlainRow<T>::value) {
      add_row(values.data(), values.size(), sizeof(T));
    } else {
      (*this)(std::uint64_t{values.size()});
      for (const T& value : values)
        (*this)(value);
    }
  }

  const std::string& bytes() const noexcept { return bytes_; }
  std::string take() noexcept { return std::move(bytes_); }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }

 private:
  void add_row(const void* from, std::size_t count, std::size_t size) {
    (*this)(std::uint64_t{count});
    add(from, count * size);
  }
  void add(const void* from, std::size_t size) {
    if (size > 0)
      bytes_.append(static_cast<const char*>(from), size);
  }
  std::string bytes_;
};

/// Takes the values back in the order in which they were written. Throws StoredBytesError where the
/// bytes end before.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) noexcept : rest_(bytes) {}

  template <PlainNumber T>
  void operator()(T& value) {
    take(&value, sizeof value);
  }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    require(byte <= 1, "a switch that is neither on nor off");
    value = byte == 1;
  }
  template <int R, int C>
  void operator()(Eigen::Matrix<double, R, C>& value) {
    take(value.data(), sizeof(double) * R * C);
  }
  void operator()(std::string& value) {
    value.resize(count(1));
    take(value.data(), value.size());
  }
  template <class T>
  void operator()(std::optional<T>& value) {
    bool is_there = false;
    (*this)(is_there);
    value.reset();
    if (is_there)
      (*this)(value.emplace());
  }
  template <class T, class Allocator>
  void operator()(std::vector<T, Allocator>& values) {
    if constexpr (stored_bytes::IsPlainRow<T>::value) {
      const std::size_t size = count(sizeof(T));
      values.reserve(size), values.resize(size);
      take(values.data(), size * sizeof(T));
    } else {
      const std::size_t size = count(1);  // each takes a byte at least
      values.clear();
      for (std::size_t n = 0; n < size; ++n)
        (*this)(values.emplace_back());
    }
  }

  /// Throws StoredBytesError with `what` unless it holds.
  static void require(bool holds, const char* what) {
    if (!holds)
      throw StoredBytesError(what);
  }
  /// Nothing may follow.
  void finish() const { require(rest_.empty(), "bytes behind the last value"); }

 private:
  std::size_t count(std::size_t size) {
    std::uint64_t n = 0;
    (*this)(n);
    require(n <= rest_.size() / size, "a length beyond the bytes that are there");
    return static_cast<std::size_t>(n);
  }
  void take(void* to, std::size_t size) {
    require(size <= rest_.size(), "bytes that end too early");
    if (size > 0)
      std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  std::string_view rest_;
};

}  // namespace voxtouch

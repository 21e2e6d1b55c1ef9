// Vector of at most kCapacity trivial elements with inline storage: no heap, copyable,
// zero-initialised.
#pragma once

#include <array>
#include <type_traits>

#include "edge/core/base/check.h"

namespace bess {

template <typename T, int kCapacity>
class StaticVector {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  constexpr void push_back(const T& value) {
    BESS_CHECK(size_ < kCapacity);
    items_[static_cast<std::size_t>(size_++)] = value;
  }
  /// Returns false and changes nothing when full: for input from outside.
  [[nodiscard]] constexpr bool try_push_back(const T& value) {
    if (size_ == kCapacity) return false;
    push_back(value);
    return true;
  }
  constexpr void clear() { size_ = 0; }
  [[nodiscard]] constexpr int size() const { return size_; }
  [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
  [[nodiscard]] static constexpr int capacity() { return kCapacity; }

  constexpr T& operator[](int i) {
    BESS_CHECK(i >= 0 && i < size_);
    return items_[static_cast<std::size_t>(i)];
  }
  constexpr const T& operator[](int i) const {
    BESS_CHECK(i >= 0 && i < size_);
    return items_[static_cast<std::size_t>(i)];
  }
  constexpr T* begin() { return items_.data(); }
  constexpr T* end() { return items_.data() + size_; }
  constexpr const T* begin() const { return items_.data(); }
  constexpr const T* end() const { return items_.data() + size_; }
  constexpr T* data() { return items_.data(); }
  constexpr const T* data() const { return items_.data(); }

 private:
  std::array<T, kCapacity> items_{};
  int size_ = 0;
};

}  // namespace bess

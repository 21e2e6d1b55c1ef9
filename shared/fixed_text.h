// Text with inline storage for names, hosts and paths of long-lived objects: no heap,
// null-terminated.
#pragma once

#include <array>
#include <string_view>

namespace bess {

template <int kCapacity>
class FixedText {
 public:
  constexpr FixedText() = default;
  /// For literals that are known to fit; longer text is cut.
  constexpr FixedText(std::string_view text) {  // NOLINT: implicit on purpose, like std::string
    static_cast<void>(assign(text));
  }
  constexpr FixedText(const char* text) : FixedText(std::string_view(text)) {}  // NOLINT: as above
  /// False when the text was cut.
  constexpr bool assign(std::string_view text) {
    size_ = text.size() < kCapacity ? text.size() : kCapacity;
    for (std::size_t i = 0; i < size_; ++i) characters_[i] = text[i];
    characters_[size_] = '\0';
    return size_ == text.size();
  }
  [[nodiscard]] constexpr std::string_view view() const { return {characters_.data(), size_}; }
  [[nodiscard]] constexpr const char* c_str() const { return characters_.data(); }
  [[nodiscard]] constexpr bool empty() const { return size_ == 0; }
  friend constexpr bool operator==(const FixedText& a, std::string_view b) { return a.view() == b; }

 private:
  std::array<char, kCapacity + 1> characters_{};
  std::size_t size_ = 0;
};

}  // namespace bess

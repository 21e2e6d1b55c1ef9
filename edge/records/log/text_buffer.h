// Text buffer of limited length with printf formats, in storage of the owner. Excess text is cut
// and `was_cut` set. No stdio stream, no heap.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string_view>

namespace bess {

class TextBuffer {
 public:
  template <std::size_t kBytes>
  explicit TextBuffer(char (&storage)[kBytes]) : begin_(storage), capacity_(kBytes) {
    storage[0] = '\0';
  }

  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int length = std::vsnprintf(begin_ + size_, capacity_ - size_, format, arguments);
    va_end(arguments);
    const std::size_t room = capacity_ - size_ - 1;
    const std::size_t wanted = length > 0 ? static_cast<std::size_t>(length) : 0;
    if (wanted > room) was_cut_ = true;
    size_ += wanted < room ? wanted : room;
  }
  [[nodiscard]] std::string_view view() const { return {begin_, size_}; }
  [[nodiscard]] bool was_cut() const { return was_cut_; }

 private:
  char* begin_;
  std::size_t capacity_;
  std::size_t size_ = 0;
  bool was_cut_ = false;
};

}  // namespace bess

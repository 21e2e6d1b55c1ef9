// Build information for --version: commit, compiler, instruction set.
#pragma once

#include <string>
#include <string_view>

namespace bess {

/// "1234abcd5678", with the suffix "-dirty" for changed files; or "unknown".
std::string_view build_commit();

/// "g++ 12.2.0" or "clang 14.0.6".
std::string_view build_compiler();

/// Inline, because it depends on the compiler options of the including file.
inline std::string_view instruction_set() {
#if defined(__AVX512F__)
  return "x86-64 with AVX-512";
#elif defined(__AVX2__) && defined(__FMA__)
  return "x86-64 with AVX2 and FMA";
#elif defined(__AVX__)
  return "x86-64 with AVX";
#elif defined(__x86_64__)
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#elif defined(__arm__) && defined(__ARM_NEON)
  return "arm with NEON";
#elif defined(__arm__)
  return "arm";
#else
  return "unknown instructions";
#endif
}

/// "commit 1234abcd5678, g++ 12.2.0, x86-64 with AVX2 and FMA"
inline std::string build_line() {
  std::string line = "commit ";
  line.append(build_commit()).append(", ").append(build_compiler()).append(", ");
  return line.append(instruction_set());
}

}  // namespace bess

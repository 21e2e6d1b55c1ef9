// What an errno says of a file, for people: the common slips in plain words, the rest in the
// system's.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace bess {

inline std::string errno_text(int error) {
  if (error == ELOOP) return "it is a link that leads back to itself; name the file itself";
  if (error == ENAMETOOLONG) return "the name is too long for a file; check it";
  return std::strerror(error);
}

}  // namespace bess

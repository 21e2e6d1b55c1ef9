// Files of secrets that a section names.
#pragma once

#include <string>

#include "shared/host/toml_reader.h"

namespace bess {

struct SecretFile {
  std::string_view key;    ///< that names it
  std::string name;        ///< as the key has it
  std::size_t bytes_max;   ///< a longer one is refused
  std::string_view shape;  ///< what it must be, for a person: "must be a text of ..."
};

/// The path, for messages; `text` is what the file holds. A file that others may read is an error,
/// as one that cannot be read or is too long.
std::string read_secret(TomlTable& table, const SecretFile& file, std::string& text);

}  // namespace bess

// Whether a version may be let in at all, before the one that works is handed over from: its files
// are whole, its header is the one of its certificate, its program decides what the certificate
// says, and it takes this machine's settings.
#pragma once

#include <string>

namespace bess {

/// `share`: the path under which settings name maps (/usr/share/bess); read from the version's own
/// folder.
struct ProofPlaces {
  std::string version_folder;
  std::string settings;  ///< may not be there yet
  std::string share;
};

/// False with one line in `error`.
bool is_proved(const ProofPlaces& places, std::string& error);

/// A member of a version's certificate; empty where there is none.
std::string certificate_fact(const std::string& version_folder, const char* member);

}  // namespace bess

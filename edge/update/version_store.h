// The versions that a machine keeps, each a folder with all that makes it: programs, maps, exported
// header, certificate, unit, and the SHA-256 of each file. What runs is a link to one of them;
// another link names the one that judges, the last that has confirmed itself. A link is flipped by
// a rename: at once, without dpkg.
//
//   /usr/lib/bess-edge/{bin,share,systemd,SUMS}       what dpkg unpacked last: a delivery, which
//                                                     nothing runs from
//   /var/lib/bess-edge/versions/VERSION/{the same}
//   /var/lib/bess-edge/current -> versions/VERSION    /usr/bin/bess-edge and /usr/share/bess lead
//                                                     here
//   /var/lib/bess-edge/confirmed -> versions/VERSION
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

class VersionStore {
 public:
  /// `root` is put before every path: empty, or a folder for tests.
  explicit VersionStore(std::string root) : root_(std::move(root)) {}

  [[nodiscard]] std::string folder() const { return root_ + "/var/lib/bess-edge"; }
  [[nodiscard]] std::string delivery() const { return root_ + "/usr/lib/bess-edge"; }
  [[nodiscard]] std::string folder_of(std::string_view version) const;
  [[nodiscard]] std::string program_of(std::string_view version) const;
  [[nodiscard]] std::vector<std::string> kept() const;

  /// False with one line in `error` when a file of that folder is not as it was made, or not there.
  static bool is_whole(const std::string& folder, std::string& error);
  [[nodiscard]] bool has_whole(std::string_view version) const;

  enum class Kept : std::uint8_t {
    kWhole,
    kRefused,  ///< it is not whole, or is another version than its name says
    kNoRoom,   ///< this machine's disk does not take it
  };
  /// Copies a folder that is whole, under this name, onto the disk. The same bytes again are
  /// nothing to do; other bytes under the name of a version that a link leads to are refused. One
  /// line in `error` unless kWhole.
  Kept keep(std::string_view version, const std::string& from, std::string& error) const;

  /// The version that a link ("current", "confirmed") leads to; empty = none.
  [[nodiscard]] std::string pointed(std::string_view link) const;
  /// Flips it, and is on the disk before it returns. Never to a version whose program is not there.
  bool point(std::string_view link, std::string_view version, std::string& error) const;

  /// Takes away what is neither listed nor led to, and what a power cut left half copied.
  void prune(const std::vector<std::string>& wanted) const;

  /// Space that is given back when a full disk refuses what must be written to go back.
  void reserve() const;
  bool use_reserve() const;

 private:
  std::string root_;
};

/// As Debian writes versions; nothing that could lead out of the folder.
bool is_version_name(std::string_view version);

}  // namespace bess

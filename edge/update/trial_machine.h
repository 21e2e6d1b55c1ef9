// What the supervisor of upgrades does to this machine: units started and stopped, links flipped,
// apt told. Each step can be done again from its begin.
#pragma once

#include <string>

#include "edge/update/trial.h"
#include "edge/update/version_store.h"

namespace bess {

class TrialMachine {
 public:
  /// `root` is put before every path: empty, or a folder for tests.
  explicit TrialMachine(std::string root) : root_(std::move(root)), store_(root_) {}

  [[nodiscard]] const VersionStore& store() const { return store_; }
  [[nodiscard]] std::string path(std::string_view of) const { return root_ + std::string(of); }
  [[nodiscard]] std::string settings() const { return path("/etc/bess/edge.toml"); }
  [[nodiscard]] std::string share() const { return path("/usr/share/bess"); }
  [[nodiscard]] TrialLimits limits() const;

  /// "ii 2.0", as dpkg has it; empty where it knows of no such package.
  static std::string delivered();
  /// The unit; `restarts` since the machine was started.
  [[nodiscard]] TrialUnit unit() const;
  /// The newest error that the unit has told since then.
  static std::string last_error(std::int64_t since_utc_s);
  static std::string boot_id();
  /// What the controller's process is of; empty where none runs, or no program of the store.
  [[nodiscard]] std::string process_version() const;

  /// The links and the unit file that this state asks for. False with one line in `error`; what a
  /// full disk refuses is tried once more with the reserve.
  bool settle(const TrialState& state, std::string& error) const;
  /// Reloads (its order stays in force), or restarts, or starts it.
  [[nodiscard]] bool hand_over(bool keeps_order) const;
  void stop() const;
  [[nodiscard]] bool start() const;
  /// apt leaves these versions alone; any other may come.
  void pin(const std::string& refused_all) const;

 private:
  [[nodiscard]] bool has_systemd() const;
  void settle_unit_file(const std::string& version) const;

  std::string root_;
  VersionStore store_;
};

}  // namespace bess

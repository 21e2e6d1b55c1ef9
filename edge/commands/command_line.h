// The sub-commands of bess-edge and their options, parsed by hand: the edge carries no option
// library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edge/storage/update_state.h"

namespace bess {

/// `run` is what bess-edge does without a sub-command; --check and --self-test make it another one.
enum class SubCommand : std::uint8_t {
  kRun,
  kCheck,
  kCommission,
  kRelease,
  kStatus,
  kLog,
  kSignature,
  kClear,
  kHold,
  kLimit,
  kRecord,
  kMapCheck,
  kSelfTest,
  kHistory
};

struct CommandLine {
  SubCommand command = SubCommand::kRun;
  std::string config_path;
  bool dry_run = false;
  bool yes = false;
  bool force = false;
  std::int64_t cycles = -1;  ///< -1 = until stopped
  bool json = false;
  bool prometheus = false;
  bool follow = false;
  bool no_lock = false;
  bool csv = false;
  std::int64_t last = -1;                ///< -1 = all
  std::int64_t since_utc_s = INT64_MIN;  ///< INT64_MIN = all
  std::optional<std::int64_t> hold_power_w;
  bool release_hold = false;
  std::int64_t for_s = 0;  ///< of hold and limit; 0 = not given
  std::string charge_w;    ///< of limit; empty = any
  std::string discharge_w;
  bool clear = false;
  std::string record_path;   ///< of run; empty = nothing is recorded
  std::string out_path;      ///< of record; empty = a name made of the time
  std::int64_t every_s = 0;  ///< of record; 0 = not given
  std::string map_path;      ///< of map check, as the next three; empty = the configuration's map
  std::string variant;
  std::string against_path;
  bool accept_cut = false;
  std::string update_folder = kUpdateFolder;  ///< of history
};

enum class CommandLineResult { kGo, kExitOk, kExitUsage };

inline constexpr const char* kDefaultConfigPath = "/etc/bess/edge.toml";

/// Prints help, version or one line about what is wrong itself.
CommandLineResult parse_command_line(int argc, char** argv, CommandLine& command_line);

}  // namespace bess

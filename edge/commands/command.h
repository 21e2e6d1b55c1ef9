// What a command of bess-edge is: one file with one row, its row, that command_list.h names. Its
// options go into a struct of its own, its function gets that struct and the settings; parsing,
// help and what is said of a slip are the same for all (command_line.cpp). By hand and not CLI11:
// options may stand before their command, the edge needs nothing of it on its target, and nothing
// here throws.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edge/settings/edge_config.h"
#include "edge/why/explanation.h"
#include "edge/why/local_moment.h"

namespace bess {

/// How an option is called, and how its value gets into the struct of its command. Without a name:
/// a word that stands alone.
struct CommandOption {
  std::string_view name;
  bool takes_value = false;
  /// False when the value is none; `wants` is then what is needed, e.g. "a whole number above 0".
  bool (*store)(void* given, std::string_view value, std::string& wants) = nullptr;
};

/// The options of a command whose struct is `Given`, each by the member that it sets.
template <typename Given>
struct OptionsOf {
  template <auto kMember>
  static constexpr CommandOption flag(std::string_view name) {
    return {name, false, [](void* given, std::string_view, std::string&) {
              return static_cast<Given*>(given)->*kMember = true;
            }};
  }
  template <auto kMember>
  static constexpr CommandOption text(std::string_view name) {
    return {name, true, [](void* given, std::string_view value, std::string& wants) {
              wants = "a file, not an empty text";  // "$UNSET" must not mean the installed file
              static_cast<Given*>(given)->*kMember = value;
              return !value.empty();
            }};
  }
  template <auto kMember>
  static constexpr CommandOption count(std::string_view name) {
    return {name, true, [](void* given, std::string_view value, std::string& wants) {
              wants = "a whole number above 0";
              std::int64_t& number = static_cast<Given*>(given)->*kMember;
              return is_whole(value, number) && number > 0;
            }};
  }
  /// A text that parse_moment() takes; what "14:32" means is known when the command runs.
  template <auto kMember>
  static constexpr CommandOption moment(std::string_view name) {
    return {name, true, [](void* given, std::string_view value, std::string& wants) {
              wants =
                  "a moment such as 14:32, yesterday, \"yesterday 14:32\", 2h (ago), \"2026-11-23 "
                  "14:32\" or 2026-11-23T13:32:00Z";
              static_cast<Given*>(given)->*kMember = value;
              std::int64_t ignored = 0;
              return parse_moment(value, 0, ignored);
            }};
  }
  template <auto kMember, std::int64_t kShortestS>
  static constexpr CommandOption duration(std::string_view name) {
    return {name, true, [](void* given, std::string_view value, std::string& wants) {
              wants = std::to_string(kShortestS % 60 == 0 ? kShortestS / 60 : kShortestS);
              wants += kShortestS % 60 == 0 ? "m" : "s";
              wants += " to 7d, such as 2h or 1h30m";
              std::int64_t& seconds = static_cast<Given*>(given)->*kMember;
              return parse_duration(value, seconds) && seconds >= kShortestS;
            }};
  }
  /// One word that stands alone and begins no option.
  template <auto kMember>
  static constexpr CommandOption word() {
    return {"", false, [](void* given, std::string_view value, std::string&) {
              std::string& word = static_cast<Given*>(given)->*kMember;
              if (!word.empty() || value.empty() || value.front() == '-') return false;
              word = value;
              return true;
            }};
  }
  /// Whole watts, once, as 2000, 2000W or 2kW; a minus before it begins no option.
  template <auto kMember>
  static constexpr CommandOption power() {
    return {"", false, [](void* given, std::string_view value, std::string&) {
              std::optional<std::int64_t>& power_w = static_cast<Given*>(given)->*kMember;
              if (value.starts_with('+')) value.remove_prefix(1);
              if (value.ends_with('W')) value.remove_suffix(1);
              const bool is_kilo = value.ends_with('k');
              if (is_kilo) value.remove_suffix(1);
              constexpr double kLargest = 1e9;
              double number = 0;
              const char* const last = value.data() + value.size();
              const auto [end, error] = std::from_chars(value.data(), last, number);
              const double watts = is_kilo ? 1e3 * number : number;
              const bool is_whole = std::abs(watts) <= kLargest && watts == std::nearbyint(watts);
              if (power_w.has_value() || error != std::errc{} || end != last || !is_whole) {
                return false;
              }
              power_w = static_cast<std::int64_t>(watts);
              return true;
            }};
  }

 private:
  static bool is_whole(std::string_view text, std::int64_t& number) {
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, number);
    return error == std::errc{} && end == last;
  }
};

/// The controller's settings, and where they were read.
struct SettingsFile {
  std::string path;
  EdgeConfig config;
};

using Words = std::vector<std::string_view>;

struct EdgeCommand {
  enum class Settings : std::uint8_t {
    kNone,     ///< there is no --config
    kLoaded,   ///< by --config or where they are installed, before the command runs
    kIfAsked,  ///< load_settings, where the command wants them
  };

  std::string_view name;
  std::string_view verb{};  ///< what is to be done has to be said besides: "check --against FILE"
  std::string_view usage;   ///< its row in the help of all, as `does`
  std::string_view does;
  const char* help;  ///< all that --help prints
  std::span<const CommandOption> options{};
  Settings settings = Settings::kLoaded;
  /// With the words behind its name; the exit code. `run_with` makes it.
  int (*run)(const EdgeCommand& command, const Words& words) = nullptr;

  [[nodiscard]] std::string_view verb_word() const { return verb.substr(0, verb.find(' ')); }
};

inline constexpr const char* kDefaultConfigPath = "/etc/bess/edge.toml";

/// One line on stderr that names the command's help; the exit code.
int usage_error(const EdgeCommand& command, const std::string& message);

/// One line on stderr, or in the journal; the exit code.
int failed(const std::string& message);

/// Nothing: go on. Otherwise it is done, with this exit code.
std::optional<int> take_options(const EdgeCommand& command, const Words& words, void* given,
                                SettingsFile& settings);

/// The one that a process runs with, still as it is by default: large, and not on the stack.
SettingsFile& settings_of_the_command();

/// Of --config, or the installed ones. Otherwise the exit code: 2 where there are none, 1 where
/// they are bad.
std::optional<int> load_settings(const EdgeCommand& command, SettingsFile& settings);

/// What is wrong with options that are right each by itself; null: nothing.
template <typename Given>
const char* all_fit(const Given&) {
  return nullptr;
}

template <typename Given, int (*kDo)(const Given&, SettingsFile&),
          const char* (*kComplaint)(const Given&) = all_fit<Given>>
int run_with(const EdgeCommand& command, const Words& words) {
  Given given;
  SettingsFile& settings = settings_of_the_command();
  if (const auto code = take_options(command, words, &given, settings)) return *code;
  if (const char* const why = kComplaint(given)) return usage_error(command, why);
  if (command.settings == EdgeCommand::Settings::kLoaded) {
    if (const auto code = load_settings(command, settings)) return *code;
  }
  return kDo(given, settings);
}

}  // namespace bess

#include "edge/storage/update_state.h"

#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "edge/log/text_checksum.h"

namespace bess {
namespace {

std::int64_t whole_of(std::string_view text) {
  std::int64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void take_line(std::string_view line, UpdateState& state) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return;
  const std::string_view key = line.substr(0, equals);
  const std::string_view value = line.substr(equals + 1);
  struct Text {
    std::string_view key;
    std::string UpdateState::*member;
  };
  constexpr Text kTexts[] = {
      {"phase", &UpdateState::phase},       {"version", &UpdateState::version},
      {"previous", &UpdateState::previous}, {"refused", &UpdateState::refused},
      {"reason", &UpdateState::reason},     {"since_utc", &UpdateState::since_utc}};
  for (const Text& text : kTexts) {
    if (text.key == key) state.*text.member = value;
  }
  if (key == "good") state.good_cycles = whole_of(value);
  if (key == "needed") state.needed_cycles = whole_of(value);
}

/// One of the two files, as bess-update writes them.
struct StateText {
  std::string text;
  bool is_there = false;
  bool is_readable = false;  ///< a text, which its checksum does not contradict
  bool is_whole = false;     ///< by its checksum, or by its last line where it has none
};

StateText read_state_text(const std::string& path) {
  StateText state;
  std::error_code ignored;
  state.is_there = std::filesystem::exists(path, ignored);
  std::ifstream file(path);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  state.text = bytes.str();
  const TextState checked = check_text(state.text, kCommentChecksum);
  state.is_readable = state.text.starts_with("phase=") && checked != TextState::kBroken;
  const std::size_t last = state.text.rfind("\nneeded=");
  const bool ends_well =
      last != std::string::npos && state.text.find('\n', last + 1) == state.text.size() - 1;
  state.is_whole = checked == TextState::kIntact || (state.is_readable && ends_well);
  return state;
}

}  // namespace

UpdateState read_update_state(const std::string& folder) {
  const std::string path = folder + "/state";
  const StateText main = read_state_text(path);
  const StateText copy = read_state_text(path + ".copy");
  UpdateState state;
  if (!main.is_there && !copy.is_there) return state;
  // Without a copy it is of a bess-update that wrote neither that nor a checksum.
  const bool main_counts = main.is_whole || (main.is_readable && !copy.is_there);
  if (!main_counts && !copy.is_whole) {
    state.phase = "failed";
    state.reason = "the state of the upgrades is lost: " + path + " and its copy are damaged";
    return state;
  }
  std::istringstream lines(main_counts ? main.text : copy.text);
  for (std::string line; std::getline(lines, line);) take_line(line, state);
  return state;
}

std::string update_note(const UpdateState& state) {
  const std::string cycles =
      std::to_string(state.good_cycles) + " of " + std::to_string(state.needed_cycles);
  const std::string refused = state.refused + " was rolled back: " + state.reason;
  if (state.phase.empty()) return "";
  if (state.phase == "trying") {
    const std::string way_back =
        state.previous.empty() ? "no version before it is kept" : "else back to " + state.previous;
    return state.version + " on trial since " + state.since_utc + ", " + cycles + " good cycles; " +
           way_back;
  }
  if (state.phase == "confirmed") return state.version + " confirmed";
  if (state.phase == "upgrading") return "a new version is being installed";
  if (state.phase == "failed" && state.version.empty()) return state.reason;
  if (state.phase == "failed") return state.version + " did not confirm: " + state.reason;
  if (state.phase == "going_back") return state.refused + " is being rolled back: " + state.reason;
  return state.version + "; " + refused;
}

std::string update_trouble(const UpdateState& state) {
  const bool ended_badly =
      state.phase == "failed" || state.phase == "going_back" || state.phase == "rolled_back";
  return ended_badly ? update_note(state) : "";
}

std::vector<UpdateEvent> read_update_history(const std::string& folder) {
  std::vector<UpdateEvent> events;
  std::ifstream file(folder + "/history");
  for (std::string line; std::getline(file, line);) {
    constexpr std::size_t kFields = 6;
    std::array<std::string, kFields> fields;
    std::size_t count = 0;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos && count < kFields; begin = end + 1) {
      end = line.find('\t', begin);
      fields[count++] = line.substr(begin, end == std::string::npos ? end : end - begin);
    }
    if (count != kFields || file.eof()) continue;  // without its line end it was torn
    events.push_back({fields[0], fields[1], fields[2], fields[3], fields[4], fields[5]});
  }
  return events;
}

}  // namespace bess

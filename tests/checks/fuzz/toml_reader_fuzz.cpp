// TOML reader of all configurations and maps: each value is read as every type.
#include "shared/host/toml_reader.h"
#include "tests/checks/fuzz/fuzz_target.h"

namespace bess {
namespace {

void check_error(const std::string& error) {
  must(error.starts_with("fuzz:"), "an error names the file");
  must(error.size() > 6 && error[5] >= '1' && error[5] <= '9', "and the line");
  must(error.find('\n') == std::string::npos, "in one line");
}

/// One value of each type: the readers of the other types complain.
void read_as_everything(const TomlValue& table, const std::string& key) {
  const auto ask = [&](auto read) {
    std::string error;
    TomlTable reader(&table, "fuzz", "[table]", error);
    read(reader);
    if (error.empty()) return 1;
    check_error(error);
    return 0;
  };
  bool boolean = false;
  std::int64_t integer = 0;
  std::int32_t scaled = 0;
  FixedText<7> text;
  const int accepted =
      ask([&](TomlTable& reader) { reader.boolean(key, boolean); }) +
      ask([&](TomlTable& reader) { reader.integer(key, integer, INT64_MIN, INT64_MAX); }) +
      ask([&](TomlTable& reader) { static_cast<void>(reader.text(key)); }) +
      ask([&](TomlTable& reader) { static_cast<void>(reader.table(key)); }) +
      ask([&](TomlTable& reader) { static_cast<void>(reader.array(key)); });
  must(accepted <= 1, "a value is of one kind");
  ask([&](TomlTable& reader) { reader.scaled(key, scaled, 100, -20'000'000, 20'000'000); });
  ask([&](TomlTable& reader) { reader.text(key, text); });
  ask([&](TomlTable& reader) { reader.finish(); });
}

void check_value(const TomlValue& value) {
  must(value.line >= 1, "a value knows its line");
  if (const auto* list = value.as<TomlArray>()) {
    for (const TomlValue& item : *list) check_value(item);
  }
  if (const auto* members = value.as<TomlMembers>()) {
    for (const auto& [key, member] : *members) {
      read_as_everything(value, key);
      check_value(member);
    }
  }
}

}  // namespace
}  // namespace bess

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  TomlValue document;
  std::string error;
  const bool ok = parse_toml_text(text_of(data, size), "fuzz", document, error);
  must(ok == error.empty(), "refused with a reason, accepted without");
  if (ok) {
    check_value(document);
  } else {
    check_error(error);
  }
  return 0;
}

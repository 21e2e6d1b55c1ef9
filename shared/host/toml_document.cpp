#include "shared/host/toml_document.h"

#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
// toml++ recurses: with toml_traps.h this prevents a stack overflow.
#define TOML_MAX_NESTED_VALUES 64
// Some assertions of toml++ fail for invalid text such as "[=]" and "a = [1,}", whose errors it
// reports correctly. With NDEBUG it would assume them: hence without NDEBUG.
#undef NDEBUG
#define TOML_ASSERT(expr) static_cast<void>(0)
#include <toml++/toml.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "shared/host/text.h"
#include "shared/host/toml_traps.h"

namespace bess {
namespace {

using FileName = std::shared_ptr<const std::string>;

TomlValue value_of(const toml::node& node, const FileName& file);

TomlArray array_of(const toml::array& items, const FileName& file) {
  TomlArray array;
  array.reserve(items.size());
  for (const toml::node& item : items) array.push_back(value_of(item, file));
  return array;
}

TomlMembers members_of(const toml::table& table, const FileName& file) {
  TomlMembers members;
  for (const auto& [key, node] : table) {
    members.emplace_hint(members.end(), key.str(), value_of(node, file));
  }
  return members;
}

TomlValue value_of(const toml::node& node, const FileName& file) {
  TomlValue value{{}, file, static_cast<int>(node.source().begin.line)};
  if (const auto* table = node.as_table()) value.held = members_of(*table, file);
  if (const auto* array = node.as_array()) value.held = array_of(*array, file);
  if (const auto* text = node.as_string()) value.held = text->get();
  if (const auto* integer = node.as_integer()) value.held = integer->get();
  if (const auto* number = node.as_floating_point()) value.held = number->get();
  if (const auto* boolean = node.as_boolean()) value.held = boolean->get();
  return value;
}

std::string complaint(const std::string& name, int line, std::string_view what) {
  // "no" is read as the beginning of nan.
  const bool is_bare_word = what.find("could not determine value type") != what.npos ||
                            what.find("expected 'nan'") != what.npos;
  return one_line(name) + ":" + std::to_string(line) + ": not valid TOML: " + one_line(what) +
         (what.find("control characters") != what.npos ? "; is a closing quote missing?" : "") +
         (is_bare_word ? "; write true or false, a number, or text in \"quotes\"" : "");
}

/// Replaces UTF-8 characters at these offsets by escapes, "\U000000E9", equivalent in a string.
std::string with_escapes(std::string_view text, const std::vector<std::size_t>& offsets) {
  std::string escaped;
  std::size_t done = 0;
  for (const std::size_t offset : offsets) {
    const auto lead = static_cast<unsigned char>(text[offset]);
    const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC0 || offset + bytes > text.size()) continue;  // not UTF-8: reported by the parser
    std::uint32_t code_point = lead & (0x7FU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
      code_point = code_point << 6 | (static_cast<unsigned char>(text[offset + i]) & 0x3FU);
    }
    escaped.append(text, done, offset - done).append(formatted("\\U%08X", code_point));
    done = offset + bytes;
  }
  return escaped.append(text, done);
}

/// Reads at most one byte more than the limit, which shows that the file is too large.
bool read_whole_file(const std::string& path, std::string& text, std::string& error) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) {
    error = path + ": cannot open: " + std::strerror(errno);
    return false;
  }
  char buffer[4096];
  std::size_t got = 0;
  while (text.size() <= kTomlBytesMax && (got = std::fread(buffer, 1, sizeof buffer, file)) > 0) {
    text.append(buffer, got);
  }
  const bool read_failed = std::ferror(file) != 0;
  std::fclose(file);
  if (read_failed) error = path + ": cannot read (a folder?)";
  return !read_failed;
}

}  // namespace

std::optional<double> TomlValue::number() const {
  if (const auto* integer = as<std::int64_t>()) return static_cast<double>(*integer);
  if (const auto* number = as<double>()) return *number;
  return {};
}

const TomlValue* TomlValue::find(std::string_view key) const {
  const auto* members = as<TomlMembers>();
  if (members == nullptr) return nullptr;
  const auto found = members->find(key);
  return found == members->end() ? nullptr : &found->second;
}

bool parse_toml_text(std::string_view text, const std::string& name, TomlValue& document,
                     std::string& error) {
  if (text.size() > kTomlBytesMax) {
    error = complaint(name, 1, "exceeds the limit of 256 KiB");
    static_assert(kTomlBytesMax == 256 * 1024);
    return false;
  }
  text = without_byte_order_mark(text);
  TomlTrapFinder traps(text);
  if (const TomlTrap trap = traps.find(); trap.line > 0) {
    error = complaint(name, trap.line, trap.message);
    return false;
  }
  const toml::parse_result result =
      toml::parse(with_escapes(text, traps.continued_letters()), name);
  if (result.failed()) {
    error = complaint(name, static_cast<int>(result.error().source().begin.line),
                      result.error().description());
    return false;
  }
  document = value_of(result.table(), std::make_shared<const std::string>(name));
  return true;
}

bool parse_toml_file(const std::string& path, TomlValue& document, std::string& error) {
  std::string text;
  return read_whole_file(path, text, error) && parse_toml_text(text, path, document, error);
}

}  // namespace bess

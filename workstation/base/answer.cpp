#include "workstation/base/answer.h"

#include <algorithm>

namespace bess {

std::string value_in(const Entries& entries, std::string_view name) {
  const auto found = std::ranges::find(entries, name, &Entries::value_type::first);
  return found == entries.end() ? std::string() : found->second;
}

Json answer(const char* kind, std::initializer_list<JsonMember> members) {
  Json json = Json::object({{"schema_version", kSchemaVersion}, {"answer", kind}});
  for (const JsonMember& member : members) json.set(member.key, std::move(member.value));
  return json;
}

Json text_or_null(const std::string& text) { return text.empty() ? Json::null() : Json(text); }

}  // namespace bess
